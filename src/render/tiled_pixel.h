#pragma once

// The order in which the pixels of a picture are given out: tiles of 8 x 4, row by row, so that the 32 camera rays of a
// warp stay together.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

/// The pixel that comes as number `i`. Columns and rows that do not fill a tile come last.
HD inline uint32_t tiled_pixel(uint32_t i, uint32_t width, uint32_t height) {
    const uint32_t tiles_x = width / 8, tiles_y = height / 4, tiled = tiles_x * tiles_y * 32;
    if (i < tiled) {
        const uint32_t tile = i / 32, within = i % 32;
        return (tile / tiles_x * 4 + within / 8) * width + tile % tiles_x * 8 + within % 8;
    }
    i -= tiled;
    const uint32_t right = width - tiles_x * 8, in_right = right * tiles_y * 4;
    if (i < in_right) return i / right * width + tiles_x * 8 + i % right;
    return tiles_y * 4 * width + (i - in_right);
}

} // namespace pertev
