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

std::vector<FilmLayer> CentreTarget::layers(uint32_t width, uint64_t samples) const {
    std::vector<FilmLayer> layers;
    for (const AovGroup& group : kAovTable) {
        if ((aovs_ & group.bit) == 0 || !group.is_summed) continue;
        FilmLayer& layer = layers.emplace_back(FilmLayer{group.layer, channel_names(group), {}});
        const auto channels = static_cast<uint32_t>(layer.channels.size());
        layer.image = {width, static_cast<uint32_t>(pixels_ / width), channels, {}};
        layer.image.pixels.resize(pixels_ * channels);
        if (samples == 0) continue;
        queue().copy_to_host(layer.image.pixels.data(), arrays().of(group.bit), pixels_ * channels * sizeof(float));
    }
    return layers;
}

} // namespace pertev
