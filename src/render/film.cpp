#include "render/film.h"

#include <algorithm>

#include "base/error.h"
#include "device/launch.h"
#include "render/film_stages.h"

namespace pertev {
namespace {

/// Calls add(first, from, count) for a few elements at a time of `values`, which lie in `from` in memory of `queue`:
/// where they are, or copied there from another queue's.
template <class T, class Add>
void visit_in(Queue& queue, Queue& theirs, const Buffer<T>& values, const Add& add) {
    constexpr std::size_t kAtOnce = std::size_t(1) << 20; // 16 MiB of sums
    const bool is_here = &queue == &theirs;
    std::vector<T> on_host;
    Buffer<T> copy;
    if (!is_here) {
        on_host.resize(std::min(kAtOnce, values.size()));
        copy = Buffer<T>(queue, on_host.size(), "film to be added");
    }
    for (std::size_t first = 0; first < values.size(); first += kAtOnce) {
        const std::size_t count = std::min(kAtOnce, values.size() - first);
        const T* from = values.data() + first;
        if (!is_here) {
            theirs.copy_to_host(on_host.data(), from, count * sizeof(T));
            copy.upload({on_host.data(), count});
            from = copy.data();
        }
        add(first, from, static_cast<uint32_t>(count));
    }
    queue.wait(); // before the copy goes
}

} // namespace

Film::Film(Queue& queue, uint32_t width, uint32_t height, uint32_t aovs, uint32_t light_layers)
    : queue_(&queue), width_(width), height_(height), aovs_(aovs), light_layers_(light_layers),
      channels_(film_channel_count(aovs) + 3 * light_layers),
      sums_(queue, std::size_t(width) * height * channels_, "film"),
      ids_(queue, (aovs & kAovIds) != 0 ? std::size_t(width) * height : 0, "film ids"),
      invalid_(queue, 1, "invalid samples"),
      resolved_(queue, std::size_t(width) * height * kFilmColorChannels, "resolved film") {
    clear();
}

std::size_t Film::predicted_bytes(uint32_t width, uint32_t height, uint32_t aovs, uint32_t light_layers) {
    const std::size_t of_pixel = (film_channel_count(aovs) + std::size_t(3) * light_layers) * sizeof(FixedSum) +
                                 ((aovs & kAovIds) != 0 ? sizeof(PixelIds) : 0) + kFilmColorChannels * sizeof(float);
    return std::size_t(width) * height * of_pixel + sizeof(uint64_t);
}

void Film::clear() {
    sums_.zero();
    ids_.fill(0xff); // kNoHit
    invalid_.zero();
}

FilmView Film::view() const {
    return {sums_.data(), ids_.data(), invalid_.data(), channels_, aovs_, width_, height_, {}, {}};
}

void Film::add(const Film& other) {
    PERTEV_CHECK(other.width_ == width_ && other.height_ == height_ && other.aovs_ == aovs_ &&
                 other.light_layers_ == light_layers_);
    visit_in(*queue_, *other.queue_, other.sums_, [&](std::size_t first, const FixedSum* from, uint32_t count) {
        launch(*queue_, "add_films", count, AddSums{from, sums_.data() + first});
    });
    visit_in(*queue_, *other.queue_, other.ids_, [&](std::size_t first, const PixelIds* from, uint32_t count) {
        launch(*queue_, "add_film_ids", count, AddIds{from, ids_.data() + first});
    });
    const uint64_t invalid = invalid_samples() + other.invalid_samples();
    invalid_.upload({&invalid, 1});
}

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
