#pragma once

// The order in which paths, ray trees and subpaths begin. All samples of a pixel come first, then those of the next
// pixel. Thus the paths in flight come from a few adjacent pixels and access the same nodes, triangles and textures
// while caches hold them (docs/performance.md, "The order in which samples begin"). No picture depends on this order;
// a sample's random numbers are independent of it (math/sampler.h).

#include <cstdint>

#include "base/host_device.h"
#include "render/tiled_pixel.h"

namespace pertev {

/// Rows of tiles in a band. A band is 64 pixels high and is processed column by column, so that a thousand or more
/// consecutive pixels form an approximate square.
inline constexpr uint32_t kBandRows = 16;

/// The pixel at `index` of the order.
HD inline uint32_t ordered_pixel(uint32_t index, uint32_t width, uint32_t height) {
    return tiled_pixel(index, width, height, kBandRows);
}

/// A sample of a pixel; the pixel is counted row by row in a film.
struct PixelSample {
    uint32_t pixel, sample;
};

/// Samples [first_sample, + samples) of the pixels at positions [first_index, + pixels) of ordered_pixel.
struct BeginOrder {
    uint32_t first_index, pixels, first_sample, samples;

    HD uint64_t count() const { return uint64_t(pixels) * samples; }
    /// The sample with the index `number` < count(), in a picture of width x height.
    HD PixelSample at(uint64_t number, uint32_t width, uint32_t height) const {
        const uint32_t index = static_cast<uint32_t>(number / samples);
        const uint32_t sample = static_cast<uint32_t>(number - uint64_t(index) * samples);
        return {ordered_pixel(first_index + index, width, height), first_sample + sample};
    }
};

} // namespace pertev
