#pragma once

// Means of a frame over square blocks of pixels, for the exposure: light that surfaces scatter towards the camera,
// and all light. Two stages: rows of blocks, then blocks, each summed in a fixed order, so that the sums are the same
// everywhere.

#include "denoise/shown_color.h"

namespace pertev {

/// Sums over pixels. A pixel that shows mostly emitters or sky, or nothing, does not count in `scattered`.
struct BlockSums {
    Float4* scattered; // rgb, number of pixels that count
    Float4* all;       // rgb, number of pixels
};

/// Side of a block in pixels: some 40 blocks along the longer side.
inline uint32_t block_side(uint32_t width, uint32_t height) {
    const uint32_t longer = width > height ? width : height;
    return longer < 80 ? 1 : longer / 40;
}

inline uint32_t block_columns(uint32_t width, uint32_t side) { return (width + side - 1) / side; }

/// Number of elements for sums and means of a frame: sums of rows, both; then means, both.
inline std::size_t float4s_of_tones(uint32_t width, uint32_t height) {
    const uint32_t side = block_side(width, height);
    const std::size_t columns = block_columns(width, side), rows = (height + side - 1) / side;
    return 2 * columns * (height + rows);
}

/// The stage that sums the part of a row of pixels in a block, with one call per row of pixels and column of blocks.
struct SumBlockRows {
    const Float4* shown; // shown_color
    NoisyFrameView frame;
    uint32_t width, side, columns;
    BlockSums rows; // [height * columns]

    HD void operator()(uint32_t i) const {
        const uint32_t y = i / columns, first = (i % columns) * side;
        const uint32_t end = first + side < width ? first + side : width;
        Rgb scattered = {0, 0, 0}, all = {0, 0, 0};
        float counted = 0;
        for (uint32_t x = first; x < end; ++x) {
            const uint32_t pixel = y * width + x;
            const Rgb light = light_of_shown(rgb_of(shown[pixel])), emission = rgb_of(frame.emission[pixel]);
            all += light;
            const Rgb rest = light - emission;
            if (bits_of(frame.hit[pixel].x) == kNoHit || !(luminance(rest) >= luminance(emission))) continue;
            scattered += Rgb{max(rest.r, 0.0f), max(rest.g, 0.0f), max(rest.b, 0.0f)};
            counted += 1;
        }
        rows.scattered[i] = with_w(scattered, counted);
        rows.all[i] = with_w(all, static_cast<float>(end - first));
    }
};

/// The stage that computes the mean of each block, and in w of `scattered` the fraction that counts.
struct MeanOfBlockRows {
    BlockSums rows;
    uint32_t height, side, columns;
    BlockSums means; // [rows of blocks * columns]

    HD void operator()(uint32_t i) const {
        const uint32_t column = i % columns, first = (i / columns) * side;
        const uint32_t end = first + side < height ? first + side : height;
        Rgb scattered = {0, 0, 0}, all = {0, 0, 0};
        float counted = 0, count = 0;
        for (uint32_t y = first; y < end; ++y) {
            const uint32_t at = y * columns + column;
            scattered += rgb_of(rows.scattered[at]);
            counted += rows.scattered[at].w;
            all += rgb_of(rows.all[at]);
            count += rows.all[at].w;
        }
        means.scattered[i] = with_w((1.0f / count) * scattered, counted / count);
        means.all[i] = with_w((1.0f / count) * all, 1);
    }
};

} // namespace pertev
