#pragma once

// Classifies a micro-triangle (device_scene/micro_triangle.h): bounds its alpha by lookups in the box of its texture
// coordinates, with a margin for rounding, and tests whether alpha's rule (device_scene/accept_hit.h) gives one
// result for all of it.

#include <cstdint>

#include "device_scene/micro_triangle.h"
#include "device_scene/scene_view.h"
#include "device_scene/texel_bounds.h"
#include "device_scene/textured_factor.h"

namespace pertev {

/// Texels that lookups read along one axis: [first, last] and, if the image repeats past its edge, a second span.
struct TexelSpans {
    TexelSpan spans[2];
    uint32_t count; // 1 or 2
};

/// Wraps texels [first, last] along an axis of `size` texels.
HD inline TexelSpans wrap_texels(int first, int last, Wrap wrap, int size) {
    const auto one = [](int a, int b) {
        return TexelSpans{{{static_cast<uint32_t>(a), static_cast<uint32_t>(b)}, {}}, 1};
    };
    if (wrap == Wrap::ClampToEdge) return one(clamp(first, 0, size - 1), clamp(last, 0, size - 1));
    if (last - first >= size - 1) return one(0, size - 1);
    const auto image_of = [size](int texel) { return (texel >= 0 ? texel : texel - size + 1) / size; };
    const int from = image_of(first), to = image_of(last);
    const int a = first - from * size, b = last - to * size; // in [0, size)
    if (wrap == Wrap::Repeat) {
        if (a <= b) return one(a, b);
        return {{{static_cast<uint32_t>(a), static_cast<uint32_t>(size - 1)}, {0, static_cast<uint32_t>(b)}}, 2};
    }
    const int mirrored_a = from % 2 == 0 ? a : size - 1 - a, mirrored_b = to % 2 == 0 ? b : size - 1 - b;
    if (from == to) return one(min(mirrored_a, mirrored_b), max(mirrored_a, mirrored_b));
    if (from % 2 == 0) return one(min(mirrored_a, mirrored_b), size - 1); // back from the far edge
    return one(0, max(mirrored_a, mirrored_b));
}

/// Positions along one axis, in texels and unwrapped: integers are centres of texels.
struct TexelInterval {
    float least, most;
    int first, last; // texels that lookups there read
    bool is_known;   // false if numbers are too large to distinguish texels
};

/// Interval of lookups at coordinates within [least, most], which rounding may have moved by `error`; 1 is one image.
HD inline TexelInterval texels_between(float least, float most, float error, TextureFilter filter, uint32_t size) {
    constexpr float kMaxTexels = 0x1p22f; // integers up to here are exact
    constexpr float kMargin = 0x1p-6f;    // in texels; wrapping a coordinate into the image rounds by 2^-24
    const auto texels = static_cast<float>(size);
    const bool is_linear = filter == TextureFilter::Linear;
    const float to_centre = is_linear ? 0.5f : 0.0f;
    TexelInterval found = {(least - error) * texels - (to_centre + kMargin),
                           (most + error) * texels - (to_centre - kMargin), 0, 0, false};
    if (!(found.least > -kMaxTexels && found.most < kMaxTexels && texels < 0x1p17f)) return found;
    found.first = static_cast<int>(floor(found.least));
    found.last = static_cast<int>(floor(found.most)) + (is_linear ? 1 : 0);
    found.is_known = true;
    return found;
}

/// A texture as lookups see it, unwrapped.
struct UnwrappedTexture {
    const TexelBoundsView& texels;
    Wrap wrap_s, wrap_t;

    HD float texel(int x, int y) const {
        const TexelSpans column = wrap_texels(x, x, wrap_s, static_cast<int>(texels.image->width));
        const TexelSpans row = wrap_texels(y, y, wrap_t, static_cast<int>(texels.image->height));
        return cell_of(texels, 0, column.spans[0].first, row.spans[0].first).most; // infinite if it is not a number
    }
    /// Bilinear interpolation at (x, y).
    HD float mean(float x, float y) const {
        const float x0 = floor(x), y0 = floor(y);
        const int i = static_cast<int>(x0), j = static_cast<int>(y0);
        const float top = lerp(texel(i, j), texel(i + 1, j), x - x0);
        return lerp(top, lerp(texel(i, j + 1), texel(i + 1, j + 1), x - x0), y - y0);
    }
};

/// Range of bilinear interpolation over a box of a few texels. In each rectangle between four centres of texels the
/// extremes are at corners, so they are at the corners of the box and of the rectangles that it cuts out.
HD inline ValueRange range_of_means(const UnwrappedTexture& texture, const TexelInterval& x, const TexelInterval& y) {
    ValueRange range = {kInfinity, -kInfinity};
    bool are_numbers = true;
    for (int row = y.first; row <= y.last; ++row) {
        const float at_y = clamp(static_cast<float>(row), y.least, y.most);
        for (int column = x.first; column <= x.last; ++column) {
            const float value = texture.mean(clamp(static_cast<float>(column), x.least, x.most), at_y);
            are_numbers = are_numbers && is_finite(value);
            range = join(range, {value, value});
        }
    }
    return are_numbers ? range : any_value();
}

/// Range of all texels that are read, which bounds their interpolation.
HD inline ValueRange range_of_texels(const TexelBoundsView& bounds, const TexelSpans& x, const TexelSpans& y) {
    ValueRange range = range_of(bounds, x.spans[0], y.spans[0]);
    if (x.count > 1) range = join(range, range_of(bounds, x.spans[1], y.spans[0]));
    if (y.count > 1) range = join(range, range_of(bounds, x.spans[0], y.spans[1]));
    if (x.count > 1 && y.count > 1) range = join(range, range_of(bounds, x.spans[1], y.spans[1]));
    return range;
}

/// Range of the channel of `ref` on the micro-triangle.
HD inline ValueRange texture_range(const MeshView& mesh, const TextureRef& ref, const TexelBoundsView& bounds,
                                   TriangleIndices i, const MicroCorners& corners) {
    constexpr float kMaxUv = 0x1p100f; // sums of these are finite
    // Sum at a vertex without signs: a position and a corner round by less than 2^-20 of it together, and kMaxBeside
    // is at most 2^-20 of it.
    constexpr float kRounding = 0x1p-18f;
    Vec2 size = {0, 0};
    const float ends[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    for (const auto& end : ends) {
        const Vec2 uv = texture_coordinate(mesh, ref, i, end[0], end[1]);
        if (!(abs(uv.x) < kMaxUv && abs(uv.y) < kMaxUv)) return any_value();
        size.x = max(size.x, abs(ref.m00 * uv.x) + abs(ref.m01 * uv.y) + abs(ref.m02));
        size.y = max(size.y, abs(ref.m10 * uv.x) + abs(ref.m11 * uv.y) + abs(ref.m12));
    }
    Vec2 least = {kInfinity, kInfinity}, most = {-kInfinity, -kInfinity};
    for (const Vec2 corner : corners.at) {
        const Vec2 at = transform_uv(ref, texture_coordinate(mesh, ref, i, corner.x, corner.y));
        if (!(is_finite(at.x) && is_finite(at.y))) return any_value();
        least = {min(least.x, at.x), min(least.y, at.y)};
        most = {max(most.x, at.x), max(most.y, at.y)};
    }
    const uint32_t width = bounds.image->width, height = bounds.image->height;
    const TexelInterval x = texels_between(least.x, most.x, kRounding * size.x, ref.filter, width);
    const TexelInterval y = texels_between(least.y, most.y, kRounding * size.y, ref.filter, height);
    if (!x.is_known || !y.is_known) return any_value();
    ValueRange range = range_of_texels(bounds, wrap_texels(x.first, x.last, ref.wrap_s, static_cast<int>(width)),
                                       wrap_texels(y.first, y.last, ref.wrap_t, static_cast<int>(height)));
    if (range.least == range.most) return range; // equal texels are interpolated exactly
    const bool is_small = max(x.last - x.first, y.last - y.first) < static_cast<int>(kMaxCells);
    if (is_small && ref.filter == TextureFilter::Linear) range = range_of_means({bounds, ref.wrap_s, ref.wrap_t}, x, y);
    const float rounding = 0x1p-20f * max(abs(range.least), abs(range.most));
    return {range.least - rounding, range.most + rounding};
}

/// Range of the vertex colours' alpha.
HD inline ValueRange color_range(const MeshView& mesh, TriangleIndices i) {
    const float a = mesh.colors[i.a].w, b = mesh.colors[i.b].w, c = mesh.colors[i.c].w;
    if (!(is_finite(a) && is_finite(b) && is_finite(c))) return any_value();
    const ValueRange range = {min(a, min(b, c)), max(a, max(b, c))};
    if (range.least == range.most) return range; // equal values are interpolated exactly
    const float rounding = 0x1p-20f * max(abs(range.least), abs(range.most));
    return {range.least - rounding, range.most + rounding};
}

/// Stage that computes word i of the micromaps of one mesh with one material; a word has 16 micro-triangles, ordered
/// by triangle.
struct ClassifyOpacity {
    SceneView scene;
    uint32_t mesh, material, level;
    TexelBoundsView color, alpha; // for the material's textures with these names, if present
    uint32_t* words;

    HD void operator()(uint32_t i) const {
        const uint32_t per_triangle = words_per_triangle(level);
        const uint32_t primitive = i / per_triangle, first = i % per_triangle * kMicroTrianglesPerWord;
        uint32_t states = 0;
        for (uint32_t k = 0; k < kMicroTrianglesPerWord; ++k) {
            const MicroCorners corners = corners_of(level, micro_triangle_at(level, first + k));
            states |= static_cast<uint32_t>(opacity_within(primitive, corners)) << 2 * k;
        }
        words[i] = states;
    }

    HD Opacity opacity_within(uint32_t primitive, const MicroCorners& corners) const {
        const MaterialParameters& surface = scene.materials[material];
        const MeshView& shape = scene.meshes[mesh];
        const TriangleIndices i = triangle_indices(shape, primitive);
        ValueRange range = {surface.alpha, surface.alpha}; // multiplied by the others in the order of alpha_at
        if (surface.base_color_texture.has_image())
            range = multiply(range, texture_range(shape, surface.base_color_texture, color, i, corners));
        if (surface.alpha_texture.has_image())
            range = multiply(range, texture_range(shape, surface.alpha_texture, alpha, i, corners));
        if (shape.colors != nullptr) range = multiply(range, color_range(shape, i));
        // The coin of a blended surface is in (0, 1).
        const bool is_mask = surface.alpha_mode == AlphaMode::Mask;
        if (range.least >= (is_mask ? surface.alpha_cutoff : 1.0f)) return Opacity::Opaque;
        if (is_mask ? range.most < surface.alpha_cutoff : range.most <= 0) return Opacity::Transparent;
        return Opacity::Unknown;
    }
};

} // namespace pertev
