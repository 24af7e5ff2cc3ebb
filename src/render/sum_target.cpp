#include "render/sum_target.h"

#include <utility>

namespace pertev {
namespace {

uint32_t channels_of(uint32_t aovs, const std::vector<std::string>& light_layers) {
    return film_channel_count(aovs) + 3 * static_cast<uint32_t>(light_layers.size());
}

} // namespace

SumTarget::SumTarget(Queue& queue, std::size_t pixels, uint32_t aovs, std::vector<std::string> light_layers)
    : ElementTarget(queue, pixels * channels_of(aovs, light_layers), "film"), pixels_(static_cast<uint32_t>(pixels)),
      aovs_(aovs), channels_(channels_of(aovs, light_layers)), light_layers_(std::move(light_layers)),
      resolved_(queue, pixels * kFilmColorChannels, "resolved film") {}

void SumTarget::show(FilmView& view) const {
    view.sums = elements().data();
    view.channels = channels_;
    view.aovs = aovs_;
}

bool SumTarget::is_like(const FilmTarget& other) const {
    const auto* const same = dynamic_cast<const SumTarget*>(&other);
    return same != nullptr && same->aovs_ == aovs_ && same->light_layers_ == light_layers_ &&
           ElementTarget::is_like(other);
}

std::vector<FilmLayer> SumTarget::layers(uint32_t width, uint64_t samples) const {
    std::vector<FilmLayer> layers;
    for (const AovGroup& group : kAovTable) {
        if ((aovs_ & group.bit) == 0 || !group.is_summed) continue;
        const std::vector<std::string> channels = channel_names(group);
        layers.push_back({group.layer, channels,
                          resolve(width, samples, channel_offset(aovs_, group.bit),
                                  static_cast<uint32_t>(channels.size()), group.over_hits)});
    }
    uint32_t first = film_channel_count(aovs_);
    for (const std::string& name : light_layers_) {
        layers.push_back({name, {"R", "G", "B"}, resolve(width, samples, first, 3, false)});
        first += 3;
    }
    return layers;
}

const void* SumTarget::display(uint64_t samples, ToneMap kind, float exposure_stops, bool transparent) const {
    static_assert(kFilmColorChannels * sizeof(float) >= 4);
    launch(queue(), "display_film", pixels_,
           DisplayFilm{view(), samples, kind, exposure_scale(exposure_stops), transparent,
                       reinterpret_cast<uint8_t*>(resolved_.data())});
    return resolved_.data();
}

void SumTarget::resolve_into(float* to, uint32_t pixels, uint64_t samples, uint32_t first, uint32_t channels,
                             bool over_hits) const {
    launch(queue(), "resolve_film", pixels, ResolveFilm{view(), first, channels, over_hits, samples, to});
}

Image SumTarget::resolve(uint32_t width, uint64_t samples, uint32_t first, uint32_t channels, bool over_hits) const {
    resolve_into(resolved_.data(), pixels_, samples, first, channels, over_hits);
    Image image{width, pixels_ / width, channels, {}};
    image.pixels.resize(std::size_t(pixels_) * channels);
    queue().copy_to_host(image.pixels.data(), resolved_.data(), image.pixels.size() * sizeof(float));
    return image;
}

} // namespace pertev
