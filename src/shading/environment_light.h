#pragma once

// Light from infinitely far away: radiance by direction, and sampling of directions. Conventions of scene/light.h:
// the middle column looks along -z, +x is a quarter of the image to its right, row 0 is +y.
//
// Radiance is bilinear between the centres of texels, and so is the sampling density. A patch lies between the
// centres of four texels; at each pole a row of patches, half as high, repeats the texels of the last row. Cdfs with
// guide tables select a patch (its row by y, its column by x), so that near pairs of numbers select near directions.
// The rest of the numbers selects a position in the patch, with a density that is bilinear between the brightness of
// its corners, in longitude and solid angle. Thus radiance over density is nearly constant if colours are:
// sin^2(theta / 2), theta from the nearer pole, is uniform in solid angle like cos(theta) but keeps its precision.

#include <cstdint>
#include <vector>

#include "base/host_device.h"
#include "base/sink.h"
#include "math/bilinear_patch.h"
#include "math/portable_math.h"
#include "math/rgb.h"
#include "math/scalar.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "scene/light.h"
#include "shading/guided_cdf.h"

namespace pertev {

struct EnvironmentView {
    uint32_t width = 1, height = 1;
    const Rgb* pixels = nullptr;       // [height * width], W/(sr m2), scale applied, 0 or within [2^-100, 2^120]
    const float* row_bounds = nullptr; // [height / 2 + 2], sin^2(theta / 2) at the upper edge of each row of patches
    GuidedCdfView rows;                // [height + 1] rows of patches; empty if black
    GuidedCdfView columns;             // [width] for row 0, followed by the tables of the other rows
    float rotation_turns = 0;          // [0, 1): rotation around +y, 1 is a full turn
    bool is_constant = true;           // radiance is uniform, `constant`; pixels and row_bounds are not read
    Rgb constant;
    Rgb mean; // over all directions, W/(sr m2)
};

/// Position in the image in texels: x in [0, width], y in [0, height], (0, 0) is the upper left corner.
HD inline Vec2 environment_uv(const EnvironmentView& view, Vec3 direction) {
    const float longitude = atan2(direction.x, -direction.z); // 0 along -z
    const float from_north = atan2(sqrt(square(direction.x) + square(direction.z)), direction.y);
    const float turns = longitude * (0.5f * kInvPi) + 0.5f + view.rotation_turns;
    return {(turns - floor(turns)) * static_cast<float>(view.width),
            from_north * kInvPi * static_cast<float>(view.height)};
}

/// Position of a direction among the patches. Patch (column, row) extends from the centre of texel column `column` to
/// that of the next one, which wraps, and from the centre of texel row `row` - 1 to that of row `row`; at the poles
/// both are the last row.
struct PanoramaPoint {
    uint32_t column, row; // column < width, row <= height
    Vec2 at;              // [0, 1], from the left and the upper edge; linear in the angles
};

HD inline PanoramaPoint panorama_point(const EnvironmentView& view, Vec2 uv) {
    const int last_x = static_cast<int>(view.width) - 1, last_y = static_cast<int>(view.height) - 1;
    const float x = uv.x - 0.5f, y = uv.y - 0.5f;
    const float x_below = floor(x), y_below = floor(y);
    const int column = to_int(x_below, -1, last_x);
    return {static_cast<uint32_t>(column < 0 ? last_x : column),
            static_cast<uint32_t>(to_int(y_below, -1, last_y) + 1),
            {x - x_below, y - y_below}};
}

/// Radiance at the corners of a patch.
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

/// Returns the density within a patch, relative to its width and its solid angle. A corner counts as at least 2^-12
/// of the brightest, because rounding moves a position by as much in row 2048, and its density must not be 0 beside a
/// sun. `greatest` is the brightness of the brightest corner, above 0.
HD inline BilinearPatch panorama_density(const PanoramaCorners& corners, float& greatest) {
    const float a = panorama_brightness(corners.upper_left), b = panorama_brightness(corners.upper_right);
    const float c = panorama_brightness(corners.lower_left), d = panorama_brightness(corners.lower_right);
    greatest = max(max(a, b), max(c, d));
    const float inv = 1.0f / greatest, least = 0x1p-12f;
    return {max(inv * a, least), max(inv * b, least), max(inv * c, least), max(inv * d, least)};
}

/// A row of patches, relative to its nearer pole.
struct PanoramaRow {
    bool is_south;
    float from_pole;    // distance of its edge near the pole, in rows of texels
    float lower, upper; // bounds of sin^2(theta / 2), theta from that pole

    /// Returns the fraction of the solid angle between the upper edge and `s` = sin^2(theta / 2), [0, 1].
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

/// Returns the inverse of the solid angle of a patch of the row.
HD inline float patches_per_steradian(const EnvironmentView& view, const PanoramaRow& row) {
    return static_cast<float>(view.width) * (0.25f * kInvPi) / (row.upper - row.lower);
}

/// Table of the patches in row `row`.
HD inline GuidedCdfView environment_columns(const EnvironmentView& view, uint32_t row) {
    const GuidedCdfView& first = view.columns;
    return {first.starts + uint64_t(row) * (first.count + 1),
            first.guide + uint64_t(row) * ((uint64_t(1) << first.guide_bits) + 1), first.count, first.guide_bits};
}

/// sin^2(theta / 2), theta from the north or the south pole.
HD inline float sine_squared_of_half(Vec3 direction, bool is_south) {
    const float across = square(direction.x) + square(direction.z), size = sqrt(across + square(direction.y));
    const float near = across / (2.0f * size * (size + abs(direction.y))); // from the nearer pole
    return (direction.y < 0) == is_south ? near : 1.0f - near;
}

/// Density of a direction in a patch, 1/sr; 0 if the patch is black.
HD inline float panorama_pdf(const EnvironmentView& view, const PanoramaPoint& point, const PanoramaCorners& corners,
                             Vec3 direction) {
    const float pmf = cdf_pmf(view.rows, point.row) * cdf_pmf(environment_columns(view, point.row), point.column);
    if (!(pmf > 0)) return 0;
    const PanoramaRow row = panorama_row(view, point.row);
    float greatest;
    const BilinearPatch density = panorama_density(corners, greatest);
    const float share = row.share(sine_squared_of_half(direction, row.is_south));
    return pmf * patches_per_steradian(view, row) * density.pdf({point.at.x, share});
}

/// Environment light of a direction.
struct EnvironmentHit {
    Rgb radiance; // W/(sr m2)
    float pdf;    // density of sample_environment, 1/sr; 0 if black or not requested
};

/// Finds the light from `direction`, which leads away from the surface and has any length but 0.
HD inline EnvironmentHit find_environment(const EnvironmentView& view, Vec3 direction, bool wants_pdf) {
    const bool is_drawn = wants_pdf && view.rows.starts != nullptr;
    if (view.is_constant) return {view.constant, is_drawn ? 0.25f * kInvPi : 0.0f};
    const PanoramaPoint point = panorama_point(view, environment_uv(view, direction));
    const PanoramaCorners corners = panorama_corners(view, point.column, point.row);
    return {corners.radiance(point.at), is_drawn ? panorama_pdf(view, point, corners, direction) : 0.0f};
}

/// Radiance that arrives from `direction`, W/(sr m2).
HD inline Rgb environment_radiance(const EnvironmentView& view, Vec3 direction) {
    return find_environment(view, direction, false).radiance;
}

struct EnvironmentSample {
    Vec3 wi;      // unit, towards the light
    Rgb radiance; // W/(sr m2)
    float pdf;    // 1/sr, > 0
};

/// The direction with sin^2(theta / 2) = `s` from a pole and a longitude of `turns` full turns.
template <class T = float>
HD inline Vec3Of<T> environment_direction(T s, bool is_south, T turns) {
    const T c = 1.0f - s; // square of the cosine of theta / 2
    const T sin_theta = 2.0f * safe_sqrt(s * c), cos_theta = is_south ? s - c : c - s;
    T sin_longitude, cos_longitude;
    sin_cos_2pi(turns, sin_longitude, cos_longitude);
    return {sin_theta * sin_longitude, cos_theta, -(sin_theta * cos_longitude)};
}

/// Samples a direction of a constant environment, with density 1 / (4 pi), by `u`.
template <class T = float>
HD inline Vec3Of<T> sample_constant_environment(const EnvironmentView& view, SampleBitsOf<WordOf<T>> u) {
    return environment_direction<T>(unit_interval<T>(u.y), false, unit_interval<T>(u.x) - 0.5f - view.rotation_turns);
}

/// Samples a direction by `u`. Returns false and writes nothing for a black environment.
HD inline bool sample_environment(const EnvironmentView& view, SampleBits u, EnvironmentSample& sample) {
    if (view.rows.starts == nullptr) return false;
    if (view.is_constant) {
        sample = {sample_constant_environment(view, u), view.constant, 0.25f * kInvPi};
        return true;
    }
    const uint32_t more = bits_behind(u);
    const CdfDraw row_draw = draw_ordered(view.rows, u.y, more);
    const CdfDraw draw = draw_ordered(environment_columns(view, row_draw.index), u.x, more);
    const PanoramaRow row = panorama_row(view, row_draw.index);
    const PanoramaCorners corners = panorama_corners(view, draw.index, row_draw.index);
    float greatest;
    const BilinearPatch density = panorama_density(corners, greatest);
    const Vec2 at = density.sample({rest_of(draw), rest_of(row_draw)});
    const float pmf = cdf_pmf(row_draw.owned) * cdf_pmf(draw.owned);

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
    GuidedCdf rows, columns; // tables of EnvironmentView; no rows if black
    float rotation_turns = 0;
    bool is_constant = true;
    Rgb constant;
    Rgb mean_radiance; // over all directions, W/(sr m2)
};

/// Builds the sampling tables, with the scale applied. Pixels that are negative or NaN become 0 and infinite ones
/// 65504 (the largest half float, from whose overflow they usually result), each kind with one warning. Values below
/// 2^-100 become 0, because a film resolves nothing below 2^-64. An image whose pixels are all equal, or no image,
/// becomes a constant. Takes seconds for 10^8 pixels.
EnvironmentData build_environment_light(const Environment& environment, Sink& sink);

/// View of host memory, valid as long as the data.
EnvironmentView view_of(const EnvironmentData& data);

} // namespace pertev
