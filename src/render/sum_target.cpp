#include "render/sum_target.h"

#include <algorithm>
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

std::vector<FilmLayer> SumTarget::layers(uint32_t width, const RowSamples& samples) const {
    std::vector<FilmLayer> layers;
    for (const AovGroup& group : kAovTable) {
        if ((aovs_ & group.bit) == 0 || !group.is_summed) continue;
        const std::vector<std::string> channels = channel_names(group);
        const auto count = static_cast<uint32_t>(channels.size());
        layers.push_back({group.layer, channels,
                          resolve(width, samples, {channel_offset(aovs_, group.bit), count, group.over_hits})});
    }
    uint32_t first = film_channel_count(aovs_);
    for (const std::string& name : light_layers_) {
        layers.push_back({name, {"R", "G", "B"}, resolve(width, samples, {first, 3, false})});
        first += 3;
    }
    return layers;
}

const void* SumTarget::display(uint32_t width, const RowSamples& samples, ToneMap kind, float exposure_stops,
                               bool transparent) const {
    static_assert(kFilmColorChannels * sizeof(float) >= 4);
    auto* const bytes = reinterpret_cast<uint8_t*>(resolved_.data());
    samples.visit_pixels(width, pixels_, [&](std::size_t first, std::size_t end, uint64_t count) {
        // The sums of no samples are 0, and so is their mean over one.
        launch(queue(), "display_film", static_cast<uint32_t>(end - first),
               DisplayFilm{view_from(first), std::max<uint64_t>(count, 1), kind, exposure_scale(exposure_stops),
                           transparent, bytes + 4 * first});
    });
    return resolved_.data();
}

void SumTarget::resolve_into(std::span<const FilmMeans> means, uint32_t width, uint32_t pixels,
                             const RowSamples& samples) const {
    PERTEV_CHECK(means.size() <= ResolveFilm::kMost);
    samples.visit_pixels(width, pixels, [&](std::size_t first, std::size_t end, uint64_t count) {
        ResolveFilm stage = {view_from(first), count, {}, static_cast<uint32_t>(means.size())};
        std::ranges::copy(means, stage.means);
        for (uint32_t k = 0; k < stage.count; ++k) stage.means[k].to += first * stage.means[k].channels;
        launch(queue(), "resolve_film", static_cast<uint32_t>(end - first), stage);
    });
}

Image SumTarget::resolve(uint32_t width, const RowSamples& samples, FilmMeans means) const {
    means.to = resolved_.data();
    resolve_into({&means, 1}, width, pixels_, samples);
    Image image{width, pixels_ / width, means.channels, {}};
    image.pixels.resize(std::size_t(pixels_) * means.channels);
    queue().copy_to_host(image.pixels.data(), resolved_.data(), image.pixels.size() * sizeof(float));
    return image;
}

} // namespace pertev
