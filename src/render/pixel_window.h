#pragma once

// Relates a pixel's index in the whole picture to its index in a film that holds a window of it. The camera ray and
// the sampler's key (sample_key) depend on the former, so a crop has the bytes of the whole picture.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

struct PixelWindow {
    uint32_t picture_width = 0; // pixels; 0 if the film is the whole picture
    uint32_t x = 0, y = 0;      // upper left pixel of the film
    uint32_t width = 0;         // pixels of the film

    bool operator==(const PixelWindow&) const = default;

    HD uint32_t pixel_at(uint32_t slot) const {
        return picture_width == 0 ? slot : (y + slot / width) * picture_width + x + slot % width;
    }
    /// Index in the film of `pixel`, which must lie in the window.
    HD uint32_t slot_of(uint32_t pixel) const {
        return picture_width == 0 ? pixel : (pixel / picture_width - y) * width + pixel % picture_width - x;
    }
};

} // namespace pertev
