#include "render/film.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/error.h"
#include "device/launch.h"
#include "render/film_stages.h"

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

Film::Film(Queue& queue, uint32_t width, uint32_t height, uint32_t aovs, std::vector<std::string> light_layers)
    : queue_(&queue), window_{.width = width, .height = height}, aovs_(aovs), light_layers_(std::move(light_layers)),
      channels_(film_channel_count(aovs) + 3 * static_cast<uint32_t>(light_layers_.size())) {
    const std::size_t pixels = std::size_t(width) * height;
    const auto take = [&]<class Target>(std::size_t count, const char* name, const Target*& taken) {
        auto target = std::make_unique<Target>(queue, count, name);
        taken = target.get();
        hold(std::move(target));
    };
    take(pixels * channels_, "film", sums_);
    if ((aovs & kAovIds) != 0) take(pixels, "film ids", ids_);
    take(1, "invalid samples", invalid_);
    resolved_ = {queue, pixels * kFilmColorChannels, "resolved film"};
}

std::size_t Film::predicted_bytes(uint32_t width, uint32_t height, uint32_t aovs,
                                  std::vector<std::string> light_layers) {
    Queue queue = Queue::make_dry_run(false);
    const Film film(queue, width, height, aovs, std::move(light_layers));
    return queue.allocated_bytes();
}

void Film::clear() {
    for (const auto& target : targets_) target->clear();
    part_ = {};
}

FilmView Film::view() const {
    FilmView view = {nullptr, nullptr, nullptr, channels_, aovs_, window_, {}};
    for (const auto& target : targets_) target->show(view);
    return view;
}

void Film::add(const Film& other) {
    PERTEV_CHECK(other.window_ == window_ && other.aovs_ == aovs_ && other.light_layers_ == light_layers_ &&
                 other.targets_.size() == targets_.size());
    for (std::size_t i = 0; i < targets_.size(); ++i) PERTEV_CHECK(targets_[i]->is_like(*other.targets_[i]));
    const std::optional<FilmPart> both = join(part_, other.part_);
    PERTEV_CHECK(both);
    for (std::size_t i = 0; i < targets_.size(); ++i) targets_[i]->add(*other.targets_[i]);
    part_ = *both;
}

std::vector<PixelIds> Film::ids() const {
    return ids_ != nullptr ? ids_->elements().download() : std::vector<PixelIds>();
}

uint64_t Film::invalid_samples() const { return invalid_->elements().download()[0]; }

Image Film::resolve(uint32_t first, uint32_t channels, bool over_hits) const {
    launch(*queue_, "resolve_film", pixel_count(),
           ResolveFilm{view(), first, channels, over_hits, part_.samples.count(), resolved_.data()});
    Image image{width(), height(), channels, {}};
    image.pixels.resize(std::size_t(pixel_count()) * channels);
    queue_->copy_to_host(image.pixels.data(), resolved_.data(), image.pixels.size() * sizeof(float));
    return image;
}

Image Film::picture(bool transparent) const { return resolve(0, transparent ? 4 : 3, false); }

void Film::display(ToneMap kind, float exposure_stops, bool transparent) {
    static_assert(kFilmColorChannels * sizeof(float) >= 4);
    PERTEV_CHECK(part_.samples.count() > 0);
    if (display_ == nullptr) display_ = queue_->make_host_copy(std::size_t(pixel_count()) * 4);
    launch(*queue_, "display_film", pixel_count(),
           DisplayFilm{view(), part_.samples.count(), kind, exposure_scale(exposure_stops), transparent,
                       reinterpret_cast<uint8_t*>(resolved_.data())});
    display_->take(resolved_.data());
    queue_->wait(*display_);
}

Rgba8Image Film::displayed() const {
    PERTEV_CHECK(display_ != nullptr);
    const auto* const bytes = static_cast<const uint8_t*>(queue_->wait(*display_));
    return {width(), height(), {bytes, bytes + std::size_t(pixel_count()) * 4}};
}

std::vector<FilmLayer> Film::layers() const {
    std::vector<FilmLayer> layers;
    for (const AovGroup& group : kAovTable) {
        if ((aovs_ & group.bit) == 0 || !group.is_summed) continue;
        const std::vector<std::string> channels = channel_names(group);
        layers.push_back(
            {group.layer, channels,
             resolve(channel_offset(aovs_, group.bit), static_cast<uint32_t>(channels.size()), group.over_hits)});
    }
    uint32_t first = film_channel_count(aovs_);
    for (const std::string& name : light_layers_) {
        layers.push_back({name, {"R", "G", "B"}, resolve(first, 3, false)});
        first += 3;
    }
    for (const auto& target : targets_) {
        for (FilmLayer& layer : target->layers(width(), part_.samples.count())) layers.push_back(std::move(layer));
    }
    return layers;
}

} // namespace pertev
