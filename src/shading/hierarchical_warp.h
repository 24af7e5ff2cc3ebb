#pragma once

// Hierarchical mean brightness of a texture over squares of 1, 2, 4, ... texels, which estimates the emission of a
// textured triangle in constant time. An emitter is often a few texels of a large atlas: an estimate from a few
// lookups would miss it, and a lower bound on the estimate would waste most light samples on black triangles.

#include <cstdint>
#include <vector>

#include "math/vec2.h"
#include "shading/texture_lookup.h"

namespace pertev {

class HierarchicalWarp {
public:
    /// Builds the averages of an image's brightness, the mean of linear red, green and blue, with negative values as 0.
    /// `linear_from_srgb` is [256].
    HierarchicalWarp(const TextureImageView& image, bool is_srgb, const float* linear_from_srgb);

    /// Approximate mean over the triangle with these texture coordinates (before ref's transform). It is 0 only if no
    /// texel that a lookup inside the triangle can read is bright.
    double mean_over_triangle(const TextureRef& ref, Vec2 uv0, Vec2 uv1, Vec2 uv2) const;

private:
    struct Level {
        uint32_t width = 0, height = 0;
        std::vector<float> cells;
    };
    std::vector<Level> levels_; // the first is the image, the last one cell
};

} // namespace pertev
