#include "render/centre_target.h"

namespace pertev {

CentreTarget::CentreTarget(Queue& queue, std::size_t pixels, uint32_t aovs)
    : ElementTarget(queue, pixels * channels(aovs), "layers at centres"), pixels_(pixels), aovs_(aovs) {}

CentreArrays CentreTarget::arrays() const {
    CentreArrays arrays;
    for (const AovGroup& group : kAovTable) {
        if ((aovs_ & group.bit) == 0 || !group.is_summed) continue;
        const uint32_t before = channel_offset(aovs_, group.bit) - kFilmColorChannels;
        arrays.of(group.bit) = elements().data() + before * pixels_;
    }
    return arrays;
}

std::vector<FilmLayer> CentreTarget::layers(uint32_t width, const RowSamples& samples) const {
    std::vector<FilmLayer> layers;
    for (const AovGroup& group : kAovTable) {
        if ((aovs_ & group.bit) == 0 || !group.is_summed) continue;
        FilmLayer& layer = layers.emplace_back(FilmLayer{group.layer, channel_names(group), {}});
        const auto channels = static_cast<uint32_t>(layer.channels.size());
        layer.image = {width, static_cast<uint32_t>(pixels_ / width), channels, {}};
        layer.image.pixels.resize(pixels_ * channels);
        const float* const from = arrays().of(group.bit);
        samples.visit_pixels(width, pixels_, [&](std::size_t first, std::size_t end, uint64_t count) {
            if (count == 0) return; // the values are missing
            queue().copy_to_host(layer.image.pixels.data() + first * channels, from + first * channels,
                                 (end - first) * channels * sizeof(float));
        });
    }
    return layers;
}

} // namespace pertev
