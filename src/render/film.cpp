#include "render/film.h"

#include <algorithm>

#include "base/error.h"
#include "device/launch.h"
#include "render/film_stages.h"

namespace pertev {
Film::Film(Queue& queue, uint32_t width, uint32_t height, uint32_t aovs, uint32_t light_layers)
    : queue_(&queue), width_(width), height_(height), aovs_(aovs), light_layers_(light_layers),
      channels_(film_channel_count(aovs) + 3 * light_layers) {
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

std::size_t Film::predicted_bytes(uint32_t width, uint32_t height, uint32_t aovs, uint32_t light_layers) {
    Queue queue = Queue::make_dry_run(false);
    const Film film(queue, width, height, aovs, light_layers);
    return queue.allocated_bytes();
}

void Film::clear() {
    for (const auto& target : targets_) target->clear();
}

FilmView Film::view() const {
    FilmView view = {nullptr, nullptr, nullptr, channels_, aovs_, width_, height_, {}, {}};
    for (const auto& target : targets_) target->show(view);
    return view;
}

void Film::add(const Film& other) {
    PERTEV_CHECK(other.width_ == width_ && other.height_ == height_ && other.aovs_ == aovs_ &&
                 other.light_layers_ == light_layers_ && other.targets_.size() == targets_.size());
    for (std::size_t i = 0; i < targets_.size(); ++i) targets_[i]->add(*other.targets_[i]);
}

std::vector<PixelIds> Film::ids() const {
    return ids_ != nullptr ? ids_->elements().download() : std::vector<PixelIds>();
}

uint64_t Film::invalid_samples() const { return invalid_->elements().download()[0]; }

Image Film::resolve(uint32_t first, uint32_t channels, bool over_hits, uint64_t samples) const {
    launch(*queue_, "resolve_film", pixel_count(),
           ResolveFilm{view(), first, channels, over_hits, samples, resolved_.data()});
    Image image{width_, height_, channels, {}};
    image.pixels.resize(std::size_t(pixel_count()) * channels);
    queue_->copy_to_host(image.pixels.data(), resolved_.data(), image.pixels.size() * sizeof(float));
    return image;
}

Image Film::light_layer(uint32_t layer, uint64_t samples) const {
    PERTEV_CHECK(layer < light_layers_);
    return resolve(film_channel_count(aovs_) + 3 * layer, 3, false, samples);
}

Image Film::picture(uint64_t samples, bool transparent) const {
    return resolve(0, transparent ? 4 : 3, false, samples);
}

void Film::display(uint64_t samples, ToneMap kind, float exposure_stops, bool transparent) {
    static_assert(kFilmColorChannels * sizeof(float) >= 4);
    if (display_ == nullptr) display_ = queue_->make_host_copy(std::size_t(pixel_count()) * 4);
    launch(*queue_, "display_film", pixel_count(),
           DisplayFilm{view(), samples, kind, exposure_scale(exposure_stops), transparent,
                       reinterpret_cast<uint8_t*>(resolved_.data())});
    display_->take(resolved_.data());
    queue_->wait(*display_);
}

Rgba8Image Film::displayed() const {
    PERTEV_CHECK(display_ != nullptr);
    const auto* const bytes = static_cast<const uint8_t*>(queue_->wait(*display_));
    return {width_, height_, {bytes, bytes + std::size_t(pixel_count()) * 4}};
}

std::vector<FilmLayer> Film::layers(uint64_t samples) const {
    std::vector<FilmLayer> layers;
    for (const AovGroup& group : kAovTable) {
        if ((aovs_ & group.bit) == 0 || !group.is_summed) continue;
        const std::vector<std::string> channels = channel_names(group);
        layers.push_back({group.layer, channels,
                          resolve(channel_offset(aovs_, group.bit), static_cast<uint32_t>(channels.size()),
                                  group.over_hits, samples)});
    }
    return layers;
}

} // namespace pertev
