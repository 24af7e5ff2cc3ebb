#pragma once

// Makes a level of a mip-map from the one below: each texel is the mean of its area, of linear values. Levels of bytes
// are bytes, those of any other depth floats. Where colours are sRGB-encoded, and thus are no other data, they count by
// their alpha, so that what is cut out does not colour the rest.

#include "image/srgb.h"
#include "shading/texture_lookup.h"

namespace pertev {

/// Size of the next level of `size` texels.
HD constexpr uint32_t halved_texels(uint32_t size) { return size > 1 ? size / 2 : 1; }

struct HalveTexture {
    TextureImageView from;
    uint32_t width, height; // halved
    bool is_srgb;
    const float* linear_from_srgb;
    uint8_t* bytes; // [width * height * 4], or null
    float* floats;  // [width * height * 4], otherwise null

    HD void operator()(uint32_t i) const {
        const Vec4 mean = mean_of(i % width, i / width);
        const size_t at = 4 * size_t(i);
        if (bytes == nullptr) {
            floats[at] = mean.x, floats[at + 1] = mean.y, floats[at + 2] = mean.z, floats[at + 3] = mean.w;
            return;
        }
        const Rgb color = {mean.x, mean.y, mean.z}, encoded = is_srgb ? srgb_encode(color) : color;
        bytes[at] = to_byte(encoded.r), bytes[at + 1] = to_byte(encoded.g), bytes[at + 2] = to_byte(encoded.b);
        bytes[at + 3] = to_byte(mean.w);
    }

private:
    /// Texels of one axis that a texel of the next level covers, at most three, and parts of them.
    struct Cover {
        uint32_t first, end;
        uint64_t begin_at, end_at; // in units of 1 / `to`
        uint32_t to;

        HD Cover(uint32_t i, uint32_t size, uint32_t halved)
            : begin_at(uint64_t(i) * size), end_at(uint64_t(i + 1) * size), to(halved) {
            first = static_cast<uint32_t>(begin_at / to);
            end = static_cast<uint32_t>((end_at + to - 1) / to);
        }
        HD float weight(uint32_t k) const {
            const uint64_t begin = uint64_t(k) * to, after = begin + to;
            return static_cast<float>((after < end_at ? after : end_at) - (begin > begin_at ? begin : begin_at));
        }
    };

    HD Vec4 mean_of(uint32_t x, uint32_t y) const {
        const Cover columns(x, from.width, width), rows(y, from.height, height);
        Vec4 sum, covered;
        float weights = 0;
        for (uint32_t row = rows.first; row < rows.end; ++row) {
            for (uint32_t column = columns.first; column < columns.end; ++column) {
                const Vec4 texel = load_texel(from, column, row, is_srgb, linear_from_srgb);
                const float weight = rows.weight(row) * columns.weight(column);
                sum = sum + weight * texel;
                covered = covered + (weight * texel.w) * texel;
                weights += weight;
            }
        }
        const float inv = 1.0f / weights;
        if (!is_srgb || !(sum.w > 0) || sum.w == weights) return inv * sum;
        const float by_alpha = 1.0f / sum.w;
        return {by_alpha * covered.x, by_alpha * covered.y, by_alpha * covered.z, inv * sum.w};
    }
};

} // namespace pertev
