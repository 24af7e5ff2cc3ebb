#pragma once

// Light from infinitely far away: radiance by direction, and directions drawn by it. Conventions of scene/light.h: the
// middle column looks along -z, +x is a quarter of the image to its right, row 0 is +y.
//
// Radiance is bilinear between the centres of texels, so that is what directions are drawn by. A patch lies between the
// centres of four texels; at each pole a row of patches, half as high, repeats the texels of the last row. Ordered
// tables draw a patch (its row by y, its column by x), so that near pairs of numbers draw near directions. What remains
// of the numbers draws a place in the patch, with a density that is bilinear between the brightness of its corners, in
// longitude and solid angle. Thus radiance over density is nearly constant where colours are: sin^2(theta / 2), theta
// from the nearer pole, is uniform in solid angle like cos(theta) but keeps its precision.

#include <cstdint>
#include <vector>

#include "base/host_device.h"
#include "base/messages.h"
#include "math/bilinear_patch.h"
#include "math/portable_math.h"
#include "math/rgb.h"
#include "math/scalar.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "scene/light.h"
#include "shading/ordered_table.h"

namespace pertev {

struct EnvironmentView {
    uint32_t width = 1, height = 1;
    const Rgb* pixels = nullptr;       // [height * width], W/(sr m2), scale applied, 0 or within [2^-100, 2^120]
    const float* row_bounds = nullptr; // [height / 2 + 2], sin^2(theta / 2) at the upper edge of each row of patches
    OrderedTableView rows;             // [height + 1] of patches; no starts: black
    OrderedTableView columns;          // [width] of row 0; the tables of the other rows lie behind it
    float rotation_turns = 0;          // [0, 1): rotation about +y, 1 is a full turn
    bool is_constant = true;           // radiance is `constant` from everywhere; pixels and row_bounds are not read
    Rgb constant;
    Rgb mean; // over all directions, W/(sr m2)
};

/// Place in the image in texels: x in [0, width], y in [0, height], (0, 0) the upper left corner.
HD inline Vec2 environment_place(const EnvironmentView& view, Vec3 direction) {
    const float longitude = atan2(direction.x, -direction.z); // 0 along -z
    const float from_north = atan2(sqrt(square(direction.x) + square(direction.z)), direction.y);
    const float turns = longitude * (0.5f * kInvPi) + 0.5f + view.rotation_turns;
    return {(turns - floor(turns)) * static_cast<float>(view.width),
            from_north * kInvPi * static_cast<float>(view.height)};
}

/// Where a direction lies among the patches. Patch (column, row) reaches from the centre of texel column `column` to
/// that of the next one, which wraps, and from the centre of texel row `row` - 1 to that of row `row`; at the poles
/// both are the last row.
struct PanoramaPlace {
    uint32_t column, row; // column < width, row <= height
    Vec2 at;              // [0, 1], from the left edge and from the upper edge; linear in the angles
};

HD inline PanoramaPlace panorama_place(const EnvironmentView& view, Vec2 place) {
    const int last_x = static_cast<int>(view.width) - 1, last_y = static_cast<int>(view.height) - 1;
    const float x = place.x - 0.5f, y = place.y - 0.5f;
    const float x_below = floor(x), y_below = floor(y);
    const int column = to_int(x_below, -1, last_x);
    return {static_cast<uint32_t>(column < 0 ? last_x : column),
            static_cast<uint32_t>(to_int(y_below, -1, last_y) + 1),
            {x - x_below, y - y_below}};
}

/// The radiance at the corners of a patch.
struct PanoramaCorners {
    Rgb upper_left, upper_right, lower_left, lower_right;

    HD Rgb radiance(Vec2 at) const {
        return lerp(lerp(upper_left, upper_right, at.x), lerp(lower_left, lower_right, at.x), at.y);
    }
};

HD inline PanoramaCorners panorama_corners(const EnvironmentView& view, uint32_t column, uint32_t row) {
    const uint32_t right = column + 1 < view.width ? column + 1 : 0;
    const Rgb* upper = view.pixels + uint64_t(row > 0 ? row - 1 : 0) * view.width;
    const Rgb* lower = view.pixels + uint64_t(min(row, view.height - 1)) * view.width;
    return {upper[column], upper[right], lower[column], lower[right]};
}

HD inline float panorama_brightness(Rgb c) { return c.r + c.g + c.b; }

/// Returns the density within a patch, over its width and its solid angle. A corner counts as no darker than 2^-12 of
/// the brightest: rounding moves a place by as much in row 2048, and its density must not be 0 beside a sun. `greatest`
/// is the brightness of the brightest corner, above 0.
HD inline BilinearPatch panorama_density(const PanoramaCorners& corners, float& greatest) {
    const float a = panorama_brightness(corners.upper_left), b = panorama_brightness(corners.upper_right);
    const float c = panorama_brightness(corners.lower_left), d = panorama_brightness(corners.lower_right);
    greatest = max(max(a, b), max(c, d));
    const float inv = 1.0f / greatest, least = 0x1p-12f;
    return {max(inv * a, least), max(inv * b, least), max(inv * c, least), max(inv * d, least)};
}

/// A row of patches, as the pole sees it that it is nearer to.
struct PanoramaRow {
    bool is_south;
    float from_pole;    // of its edge near the pole, in rows of texels
    float lower, upper; // bounds of sin^2(theta / 2), theta from that pole

    /// Returns the share of the solid angle between the upper edge and `s` = sin^2(theta / 2), [0, 1].
    HD float share(float s) const {
        const float near = clamp((s - lower) / (upper - lower), 0.0f, 1.0f);
        return is_south ? 1.0f - near : near;
    }
};

HD inline PanoramaRow panorama_row(const EnvironmentView& view, uint32_t row) {
    const bool is_south = row > view.height - row;
    const uint32_t from_pole = is_south ? view.height - row : row;
    return {is_south, from_pole > 0 ? static_cast<float>(from_pole) - 0.5f : 0.0f, view.row_bounds[from_pole],
            view.row_bounds[from_pole + 1]};
}

/// Returns one over the solid angle of a patch of the row.
HD inline float patches_per_steradian(const EnvironmentView& view, const PanoramaRow& row) {
    return static_cast<float>(view.width) * (0.25f * kInvPi) / (row.upper - row.lower);
}

/// Table of the patches of row `row`.
HD inline OrderedTableView environment_columns(const EnvironmentView& view, uint32_t row) {
    const OrderedTableView& first = view.columns;
    return {first.starts + uint64_t(row) * (first.count + 1),
            first.guide + uint64_t(row) * ((uint64_t(1) << first.guide_bits) + 1), first.count, first.guide_bits};
}

/// sin^2(theta / 2), theta from the north pole or from the south pole.
HD inline float sine_squared_of_half(Vec3 direction, bool is_south) {
    const float across = square(direction.x) + square(direction.z), size = sqrt(across + square(direction.y));
    const float near = across / (2.0f * size * (size + abs(direction.y))); // from the nearer pole
    return (direction.y < 0) == is_south ? near : 1.0f - near;
}

/// Density of a direction in a patch, 1/sr; 0 where the patch is black.
HD inline float panorama_pdf(const EnvironmentView& view, const PanoramaPlace& place, const PanoramaCorners& corners,
                             Vec3 direction) {
    const float pmf =
        ordered_pmf(view.rows, place.row) * ordered_pmf(environment_columns(view, place.row), place.column);
    if (!(pmf > 0)) return 0;
    const PanoramaRow row = panorama_row(view, place.row);
    float greatest;
    const BilinearPatch density = panorama_density(corners, greatest);
    const float share = row.share(sine_squared_of_half(direction, row.is_south));
    return pmf * patches_per_steradian(view, row) * density.pdf({place.at.x, share});
}

/// What a direction meets in the environment.
struct EnvironmentHit {
    Rgb radiance; // W/(sr m2)
    float pdf;    // of sample_environment, 1/sr; 0 where black, and where it was not wanted
};

/// `direction` leads away from the surface and has any length but 0.
HD inline EnvironmentHit find_environment(const EnvironmentView& view, Vec3 direction, bool wants_pdf) {
    const bool is_drawn = wants_pdf && view.rows.starts != nullptr;
    if (view.is_constant) return {view.constant, is_drawn ? 0.25f * kInvPi : 0.0f};
    const PanoramaPlace place = panorama_place(view, environment_place(view, direction));
    const PanoramaCorners corners = panorama_corners(view, place.column, place.row);
    return {corners.radiance(place.at), is_drawn ? panorama_pdf(view, place, corners, direction) : 0.0f};
}

/// Radiance that arrives from `direction`, W/(sr m2).
HD inline Rgb environment_radiance(const EnvironmentView& view, Vec3 direction) {
    return find_environment(view, direction, false).radiance;
}

/// Density of sample_environment at `direction`, 1/sr; 0 where black and everywhere for a black environment.
HD inline float environment_pdf(const EnvironmentView& view, Vec3 direction) {
    return find_environment(view, direction, true).pdf;
}

struct EnvironmentSample {
    Vec3 wi;      // unit, towards the light
    Rgb radiance; // W/(sr m2)
    float pdf;    // 1/sr, > 0
};

/// The direction whose sin^2(theta / 2) from a pole is `s`, and whose longitude is `turns` of a full turn.
HD inline Vec3 environment_direction(float s, bool is_south, float turns) {
    const float c = 1.0f - s; // the square of the cosine of theta / 2
    const float sin_theta = 2.0f * safe_sqrt(s * c), cos_theta = is_south ? s - c : c - s;
    float sin_longitude, cos_longitude;
    sin_cos_2pi(turns, sin_longitude, cos_longitude);
    return {sin_theta * sin_longitude, cos_theta, -(sin_theta * cos_longitude)};
}

/// A direction drawn by `u`. False, with nothing written, for a black environment.
HD inline bool sample_environment(const EnvironmentView& view, SampleBits u, EnvironmentSample& sample) {
    if (view.rows.starts == nullptr) return false;
    if (view.is_constant) {
        const float turns = unit_interval(u.x) - 0.5f - view.rotation_turns;
        sample = {environment_direction(unit_interval(u.y), false, turns), view.constant, 0.25f * kInvPi};
        return true;
    }
    const uint32_t more = bits_behind(u);
    const OrderedDraw row_draw = draw_ordered(view.rows, u.y, more);
    const OrderedDraw draw = draw_ordered(environment_columns(view, row_draw.index), u.x, more);
    const PanoramaRow row = panorama_row(view, row_draw.index);
    const PanoramaCorners corners = panorama_corners(view, draw.index, row_draw.index);
    float greatest;
    const BilinearPatch density = panorama_density(corners, greatest);
    const Vec2 at = density.sample({rest_of(draw), rest_of(row_draw)});
    const float pmf = ordered_pmf(row_draw.owned) * ordered_pmf(draw.owned);

    const float s = lerp(row.lower, row.upper, row.is_south ? 1.0f - at.y : at.y);
    const float column = static_cast<float>(draw.index) + 0.5f + at.x;
    const float turns = column / static_cast<float>(view.width) - 0.5f - view.rotation_turns;
    const float from_pole = 2.0f * kInvPi * static_cast<float>(view.height) * atan2(sqrt(s), safe_sqrt(1.0f - s));
    const float below = clamp(from_pole - row.from_pole, 0.0f, 1.0f);
    sample.wi = environment_direction(s, row.is_south, turns);
    sample.radiance = corners.radiance({at.x, row.is_south ? 1.0f - below : below});
    sample.pdf = pmf * patches_per_steradian(view, row) * density.pdf(at);
    return true;
}

struct EnvironmentData {
    uint32_t width = 1, height = 1;
    std::vector<Rgb> pixels;
    std::vector<float> row_bounds;
    OrderedTable rows, columns; // of EnvironmentView; no rows: black
    float rotation_turns = 0;
    bool is_constant = true;
    Rgb constant;
    Rgb mean_radiance; // over all directions, W/(sr m2)
};

/// The tables for sampling, scale applied. Pixels that are negative or NaN become 0 and infinite ones 65504 (the
/// largest half float, whose overflow they are as a rule), each kind with one warning. What is less than 2^-100 becomes
/// 0, for a film holds nothing below 2^-64. An image whose pixels are all equal, or no image, becomes a constant. Takes
/// seconds for 10^8 pixels.
EnvironmentData build_environment_light(const Environment& environment, Messages& messages);

/// View of host memory; valid as long as the data is.
EnvironmentView view_of(const EnvironmentData& data);

} // namespace pertev
