#pragma once

// The order in which paths, ray trees and subpaths begin. All samples of a pixel come first, then those of the next
// pixel. Thus the paths in flight come from a few adjacent pixels and access the same nodes, triangles and textures
// while caches hold them (docs/performance.md, "The order in which samples begin"). No picture depends on this order;
// a sample's random numbers are independent of it (math/sampler.h).

#include <cstdint>

#include "base/host_device.h"
#include "render/pixel_window.h"
#include "render/tiled_pixel.h"

namespace pertev {

/// Rows of tiles in a band. A band is 64 pixels high and is processed column by column, so that a thousand or more
/// consecutive pixels form an approximate square.
inline constexpr uint32_t kBandRows = 16;

/// A sample of a pixel of the picture.
struct PixelSample {
    uint32_t pixel, sample;
};

/// Samples [first_sample, + samples) of all pixels of a window.
struct BeginOrder {
    PixelWindow window;
    uint32_t first_sample, samples;

    HD uint64_t count() const { return uint64_t(window.count()) * samples; }
    /// The pixel at `index` < window.count() of the order.
    HD uint32_t pixel(uint32_t index) const {
        return window.pixel_at(FilmSlot{tiled_pixel(index, window.width, window.height, kBandRows)});
    }
    /// The sample at `number` < count() of the order.
    HD PixelSample at(uint64_t number) const {
        const uint32_t index = static_cast<uint32_t>(number / samples);
        const uint32_t sample = static_cast<uint32_t>(number - uint64_t(index) * samples);
        return {pixel(index), first_sample + sample};
    }
};

} // namespace pertev
