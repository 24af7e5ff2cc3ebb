#pragma once

// The order in which the samples of a picture begin: pixel by pixel, all samples of one after another, so that what is
// under way together comes from few pixels side by side. Its rays meet the same nodes, triangles and textures, which
// the caches then hold (docs/performance.md, "The order of samples"). No picture depends on it.

#include <cstdint>

#include "base/host_device.h"
#include "render/tiled_pixel.h"

namespace pertev {

/// Rows of tiles that are gone through together, column by column: what is under way is about as wide as high.
inline constexpr uint32_t kTileRows = 16;

/// The pixel that comes as number `place`.
HD inline uint32_t ordered_pixel(uint32_t place, uint32_t width, uint32_t height) {
    return tiled_pixel(place, width, height, kTileRows);
}

/// Which sample of which pixel.
struct PixelSample {
    uint32_t pixel, sample;
};

/// Samples [first_sample, + samples) of the pixels that come as [first_pixel, + pixels).
struct SampleOrder {
    uint32_t first_pixel, pixels, first_sample, samples;

    HD uint64_t count() const { return uint64_t(pixels) * samples; }
    /// The one that comes as `number` < count(), in a picture of width x height.
    HD PixelSample at(uint64_t number, uint32_t width, uint32_t height) const {
        const uint32_t place = static_cast<uint32_t>(number / samples);
        const uint32_t sample = static_cast<uint32_t>(number - uint64_t(place) * samples);
        return {ordered_pixel(first_pixel + place, width, height), first_sample + sample};
    }
};

} // namespace pertev
