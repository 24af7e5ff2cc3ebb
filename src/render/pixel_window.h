#pragma once

// Three numbers of a sample's pixel. The pixel itself, counted row by row in the whole picture: the camera's ray and
// the sampler's key (sample_key) are functions of it. And its place in the film, which may hold a window of the
// picture. So a crop has the bytes of the whole.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

struct PixelWindow {
    uint32_t picture_width = 0; // pixels; 0: the film is the whole picture
    uint32_t x = 0, y = 0;      // of the film's upper left pixel
    uint32_t width = 0;         // of the film

    bool operator==(const PixelWindow&) const = default;

    HD uint32_t pixel_at(uint32_t place) const {
        return picture_width == 0 ? place : (y + place / width) * picture_width + x + place % width;
    }
    /// `pixel` lies in the window.
    HD uint32_t place_of(uint32_t pixel) const {
        return picture_width == 0 ? pixel : (pixel / picture_width - y) * width + pixel % picture_width - x;
    }
};

} // namespace pertev
