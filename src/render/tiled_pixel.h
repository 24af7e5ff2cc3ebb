#pragma once

// Pixel orders: tiles of 8 x 4 pixels, row by row inside, so that the 32 camera rays of a warp are adjacent.

#include <cstdint>

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

struct PixelPosition {
    uint32_t x, y; // column, row
};

/// The pixel with index `i`. Bands of `band` rows of tiles are processed column by column; with 1, tiles come row by
/// row. Columns and rows that do not fill a tile come last.
HD inline PixelPosition tiled_position(uint32_t i, uint32_t width, uint32_t height, uint32_t band = 1) {
    const uint32_t tiles_x = width / 8, tiles_y = height / 4, tiled = tiles_x * tiles_y * 32;
    if (i < tiled) {
        const uint32_t tile = i / 32, within = i % 32;
        const uint32_t first_row = tile / (tiles_x * band) * band, rows = min(band, tiles_y - first_row);
        const uint32_t in_band = tile - first_row * tiles_x, column = in_band / rows;
        const uint32_t row = first_row + in_band - column * rows;
        return {column * 8 + within % 8, row * 4 + within / 8};
    }
    i -= tiled;
    const uint32_t right = width - tiles_x * 8, in_right = right * tiles_y * 4;
    if (i < in_right) return {tiles_x * 8 + i % right, i / right};
    i -= in_right;
    return {i % width, tiles_y * 4 + i / width};
}
HD inline uint32_t tiled_pixel(uint32_t i, uint32_t width, uint32_t height, uint32_t band = 1) {
    const PixelPosition position = tiled_position(i, width, height, band);
    return position.y * width + position.x;
}

} // namespace pertev
