#pragma once

// Minimum and maximum of one channel of an image over any box of texels: a pyramid of halved sizes, whose first level
// has cells of 2x2 texels. The texels themselves are the image's.

#include <cstdint>

#include "math/scalar.h"
#include "shading/texture_lookup.h"

namespace pertev {

/// A range of values. If a value is not finite, the range is unbounded.
struct ValueRange {
    float least, most;
};

HD constexpr ValueRange any_value() { return {-kInfinity, kInfinity}; }

HD inline ValueRange join(ValueRange a, ValueRange b) { return {min(a.least, b.least), max(a.most, b.most)}; }

/// Range of a * b for any a, b in the ranges, with the rounding of float products.
HD inline ValueRange multiply(ValueRange a, ValueRange b) {
    if (!(a.least > -kInfinity && b.least > -kInfinity && a.most < kInfinity && b.most < kInfinity)) return any_value();
    const float ll = a.least * b.least, lm = a.least * b.most, ml = a.most * b.least, mm = a.most * b.most;
    return {min(min(ll, lm), min(ml, mm)), max(max(ll, lm), max(ml, mm))};
}

inline constexpr uint32_t kMaxBoundLevels = 32; // an image's sides are 32-bit numbers

/// Columns or rows [first, last] of an image.
struct TexelSpan {
    uint32_t first, last;
};

struct TexelBoundsView {
    const ValueRange*
        levels[kMaxBoundLevels];   // [k]: ceil(height / 2^k) rows of ceil(width / 2^k), down to one cell; [0] is null
    const TextureImageView* image; // on the device
    uint32_t channel;
    bool is_srgb;
    const float* linear_from_srgb;
};

HD constexpr uint32_t halved(uint32_t size, uint32_t times) {
    return static_cast<uint32_t>((size - uint64_t(1)) >> times) + 1;
}

HD inline ValueRange cell_of(const TexelBoundsView& bounds, uint32_t level, uint32_t x, uint32_t y) {
    if (level > 0) return bounds.levels[level][uint64_t(y) * halved(bounds.image->width, level) + x];
    const float value =
        load_texel_channel(*bounds.image, x, y, bounds.channel, bounds.is_srgb, bounds.linear_from_srgb);
    return is_finite(value) ? ValueRange{value, value} : any_value();
}

/// Maximum number of cells along a side of a box that are read one by one.
inline constexpr uint32_t kMaxCells = 8;

/// Range of all texels of the box, and of some beside it.
HD inline ValueRange range_of(const TexelBoundsView& bounds, TexelSpan x, TexelSpan y) {
    uint32_t level = 0;
    while ((x.last >> level) - (x.first >> level) >= kMaxCells || (y.last >> level) - (y.first >> level) >= kMaxCells)
        ++level;
    ValueRange range = cell_of(bounds, level, x.first >> level, y.first >> level);
    for (uint32_t row = y.first >> level; row <= y.last >> level; ++row) {
        for (uint32_t column = x.first >> level; column <= x.last >> level; ++column)
            range = join(range, cell_of(bounds, level, column, row));
    }
    return range;
}

/// Stage that computes cell i of a level from the level below.
struct HalveTexelBounds {
    TexelBoundsView bounds;
    uint32_t level; // at least 1
    ValueRange* cells;

    HD void operator()(uint32_t i) const {
        const uint32_t width = halved(bounds.image->width, level);
        const uint32_t last_x = halved(bounds.image->width, level - 1) - 1;
        const uint32_t last_y = halved(bounds.image->height, level - 1) - 1;
        const uint32_t x = 2 * (i % width), y = 2 * (i / width);
        const uint32_t x1 = min(x + 1, last_x), y1 = min(y + 1, last_y);
        cells[i] = join(join(cell_of(bounds, level - 1, x, y), cell_of(bounds, level - 1, x1, y)),
                        join(cell_of(bounds, level - 1, x, y1), cell_of(bounds, level - 1, x1, y1)));
    }
};

} // namespace pertev
