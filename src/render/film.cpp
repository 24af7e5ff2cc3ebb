#include "render/film.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/error.h"
#include "render/centre_target.h"

namespace pertev {
namespace {

/// Joins two adjacent parts; nothing if they are not adjacent.
std::optional<FilmPart> join(const FilmPart& a, const FilmPart& b) {
    if (a.is_empty()) return b;
    if (b.is_empty()) return a;
    FilmPart both = a;
    if (a.first_row == b.first_row && a.end_row == b.end_row) {
        if (a.samples.end != b.samples.first && b.samples.end != a.samples.first) return std::nullopt;
        both.samples = {std::min(a.samples.first, b.samples.first), std::max(a.samples.end, b.samples.end)};
        return both;
    }
    if (!(a.samples == b.samples) || (a.end_row != b.first_row && b.end_row != a.first_row)) return std::nullopt;
    both.first_row = std::min(a.first_row, b.first_row);
    both.end_row = std::max(a.end_row, b.end_row);
    return both;
}

} // namespace

Film::Film(Queue& queue, uint32_t width, uint32_t height, uint32_t aovs, std::vector<std::string> light_layers,
           LayersAt layers_at)
    : queue_(&queue), window_{.width = width, .height = height}, end_row_(height), samples_(height), aovs_(aovs),
      layers_at_(layers_at) {
    const std::size_t pixels = std::size_t(width) * height;
    const auto take = [&]<class Target>(std::unique_ptr<Target> target, const Target*& taken) {
        taken = target.get();
        hold(std::move(target));
    };
    const bool at_centre = layers_at == LayersAt::Centre;
    if (at_centre && CentreTarget::channels(aovs) > 0) {
        take(std::make_unique<CentreTarget>(queue, pixels, aovs), centres_);
    }
    take(std::make_unique<SumTarget>(queue, pixels, at_centre ? 0 : aovs, std::move(light_layers)), sums_);
    if ((aovs & kAovIds) != 0) take(std::make_unique<IdTarget>(queue, pixels, "film ids"), ids_);
    take(std::make_unique<InvalidTarget>(queue, 1, "invalid samples"), invalid_);
}

std::size_t Film::predicted_bytes(uint32_t width, uint32_t height, uint32_t aovs, std::vector<std::string> light_layers,
                                  LayersAt layers_at) {
    Queue queue = Queue::make_dry_run(false);
    const Film film(queue, width, height, aovs, std::move(light_layers), layers_at);
    return queue.allocated_bytes();
}

void Film::clear() {
    for (const auto& target : targets_) target->clear();
    samples_ = RowSamples(height());
}

FilmPart Film::part() const {
    const std::vector<FilmPart> parts = samples_.parts();
    PERTEV_CHECK(parts.size() <= 1);
    return parts.empty() ? FilmPart() : parts.front();
}

FilmView Film::view() const {
    FilmView view = {};
    view.window = window_;
    view.is_first = first_row_ == 0;
    for (const auto& target : targets_) target->show(view);
    if (end_row_ - first_row_ == height()) return view;
    view.window = {.picture_width = width(), .y = first_row_, .width = width(), .height = end_row_ - first_row_};
    const std::size_t before = std::size_t(first_row_) * width();
    view.sums += before * view.channels;
    if (view.ids != nullptr) view.ids += before;
    return view;
}

void Film::add(const Film& other) {
    PERTEV_CHECK(other.window_ == window_ && other.targets_.size() == targets_.size());
    for (std::size_t i = 0; i < targets_.size(); ++i) PERTEV_CHECK(targets_[i]->is_like(*other.targets_[i]));
    const std::optional<FilmPart> both = join(part(), other.part());
    PERTEV_CHECK(both);
    for (std::size_t i = 0; i < targets_.size(); ++i) targets_[i]->add(*other.targets_[i]);
    set_part(*both);
}

std::vector<PixelIds> Film::ids() const {
    return ids_ != nullptr ? ids_->elements().download() : std::vector<PixelIds>();
}

uint64_t Film::invalid_samples() const { return invalid_->elements().download()[0]; }

void Film::resolve_into(float* picture, bool transparent, std::span<const LayerMemory> layers, uint32_t pixels) const {
    std::vector<FilmMeans> means;
    if (picture != nullptr) means.push_back({0, transparent ? 4u : 3u, false, picture});
    for (const auto& [group, to] : layers) {
        const AovGroup& of = aov_group(group);
        const auto channels = static_cast<uint32_t>(channel_names(of).size());
        if (centres_ == nullptr) {
            means.push_back({channel_offset(aovs_, group), channels, of.over_hits, to});
        } else {
            queue_->copy_on_device(to, centres_->arrays().of(group), std::size_t(pixels) * channels * sizeof(float));
        }
    }
    if (!means.empty()) sums_->resolve_into(means, width(), pixels, samples_);
}

CentreArrays Film::centres() const {
    CentreArrays arrays;
    if (layers_at_ == LayersAt::Samples) return arrays;
    if (centres_ != nullptr) arrays = centres_->arrays();
    if (ids_ != nullptr) arrays.ids = ids_->elements().data();
    const std::size_t before = std::size_t(first_row_) * width();
    if (before == 0) return arrays;
    if (arrays.ids != nullptr) arrays.ids += before;
    for (const AovGroup& group : kAovTable) {
        if (group.bit == kAovIds || group.bit == kAovMotion) continue;
        float*& array = arrays.of(group.bit);
        if (array != nullptr) array += before * channel_names(group).size();
    }
    return arrays;
}

void Film::display(ToneMap kind, float exposure_stops, bool transparent) {
    PERTEV_CHECK(samples_.most() > 0);
    if (display_ == nullptr) display_ = queue_->make_host_copy(std::size_t(window_.count()) * 4);
    display_->take(sums_->display(width(), samples_, kind, exposure_stops, transparent));
    queue_->wait(*display_);
}

Rgba8Image Film::displayed() const {
    PERTEV_CHECK(display_ != nullptr);
    const auto* const bytes = static_cast<const uint8_t*>(queue_->wait(*display_));
    return {width(), height(), {bytes, bytes + std::size_t(window_.count()) * 4}};
}

std::vector<FilmLayer> Film::layers() const {
    std::vector<FilmLayer> layers;
    for (const auto& target : targets_) {
        for (FilmLayer& layer : target->layers(width(), samples_)) layers.push_back(std::move(layer));
    }
    return layers;
}

} // namespace pertev
