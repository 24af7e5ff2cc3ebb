#pragma once

// Light from infinitely far away: radiance by direction, and directions drawn by it. Conventions of scene/light.h: the
// middle column looks along -z, +x is a quarter of the image to its right, row 0 is +y.
//
// A texel is drawn by ordered tables (the row by y, its column by x), so that near pairs of numbers draw near
// directions, then a direction uniformly in solid angle within it by what remains of the numbers. A texel's weight is
// its solid angle times the root mean square, over the texel, of the bilinearly filtered image: of all weights constant
// over texels the one with the least variance, and positive wherever the filter can reach light. sin^2(theta / 2),
// theta from the nearer pole, is uniform in solid angle like cos(theta) but keeps its precision.

#include <cstdint>
#include <vector>

#include "base/host_device.h"
#include "base/messages.h"
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
    const Rgb* pixels = nullptr;       // [height * width], W/(sr m2), scale applied, finite, >= 0
    const float* row_bounds = nullptr; // [height + 1], sin^2(theta / 2) at the upper edge of each row
    OrderedTableView rows;             // [height]; no starts: black
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

/// Radiance at a place: bilinear, wrapped in longitude, clamped at the poles.
HD inline Rgb environment_radiance_at(const EnvironmentView& view, Vec2 place) {
    const int last_x = static_cast<int>(view.width) - 1, last_y = static_cast<int>(view.height) - 1;
    const float x = place.x - 0.5f, y = place.y - 0.5f;
    const float x_below = floor(x), y_below = floor(y);
    const int x0 = to_int(x_below, -1, last_x), y0 = to_int(y_below, -1, last_y);
    const uint32_t left = static_cast<uint32_t>(x0 < 0 ? last_x : x0);
    const uint32_t right = static_cast<uint32_t>(x0 + 1 > last_x ? 0 : x0 + 1);
    const Rgb* top = view.pixels + uint64_t(static_cast<uint32_t>(max(y0, 0))) * view.width;
    const Rgb* bottom = view.pixels + uint64_t(static_cast<uint32_t>(min(y0 + 1, last_y))) * view.width;
    const float tx = x - x_below, ty = y - y_below;
    return lerp(lerp(top[left], top[right], tx), lerp(bottom[left], bottom[right], tx), ty);
}

/// Upper and lower bound of sin^2(theta / 2) in row `y`, theta from the pole that the row is nearer to.
HD inline Vec2 environment_row_bounds(const EnvironmentView& view, uint32_t y) {
    if (view.is_constant) return {0, 1};
    const uint32_t from_pole = min(y, view.height - 1 - y);
    return {view.row_bounds[from_pole], view.row_bounds[from_pole + 1]};
}

/// Table of the texels of row `y`.
HD inline OrderedTableView environment_columns(const EnvironmentView& view, uint32_t y) {
    const OrderedTableView& first = view.columns;
    return {first.starts + uint64_t(y) * (first.count + 1),
            first.guide + uint64_t(y) * ((uint64_t(1) << first.guide_bits) + 1), first.count, first.guide_bits};
}

/// Density of the directions in texel (x, y) with the given row bounds, 1/sr.
HD inline float environment_texel_pdf(const EnvironmentView& view, float pmf, Vec2 row_bounds) {
    return pmf * static_cast<float>(view.width) * (0.25f * kInvPi) / (row_bounds.y - row_bounds.x);
}

/// Radiance that arrives from `direction` (away from the surface, any length but 0), W/(sr m2).
HD inline Rgb environment_radiance(const EnvironmentView& view, Vec3 direction) {
    return view.is_constant ? view.constant : environment_radiance_at(view, environment_place(view, direction));
}

/// Density of sample_environment at `direction`, 1/sr; 0 where black and everywhere for a black environment.
HD inline float environment_pdf(const EnvironmentView& view, Vec3 direction) {
    if (view.rows.starts == nullptr) return 0;
    if (view.is_constant) return environment_texel_pdf(view, 1.0f, {0, 1});
    const Vec2 place = environment_place(view, direction);
    const auto x = static_cast<uint32_t>(to_int(place.x, 0, static_cast<int>(view.width) - 1));
    const auto y = static_cast<uint32_t>(to_int(place.y, 0, static_cast<int>(view.height) - 1));
    return environment_texel_pdf(view, ordered_pmf(view.rows, y) * ordered_pmf(environment_columns(view, y), x),
                                 environment_row_bounds(view, y));
}

struct EnvironmentSample {
    Vec3 wi;      // unit, towards the light
    Rgb radiance; // W/(sr m2)
    float pdf;    // 1/sr, > 0
};

/// A direction drawn by `u`. False, with nothing written, for a black environment.
HD inline bool sample_environment(const EnvironmentView& view, SampleBits u, EnvironmentSample& sample) {
    if (view.rows.starts == nullptr) return false;
    uint32_t x = 0, y = 0;
    Vec2 rest = {unit_interval(u.x), unit_interval(u.y)}; // of the texel, from its left and from its edge near a pole
    float pmf = 1;
    if (!view.is_constant) {
        const uint32_t more = bits_behind(u);
        const OrderedDraw row = draw_ordered(view.rows, u.y, more);
        const OrderedDraw texel = draw_ordered(environment_columns(view, row.index), u.x, more);
        x = texel.index, y = row.index;
        rest = {rest_of(texel), rest_of(row)};
        pmf = ordered_pmf(row.owned) * ordered_pmf(texel.owned);
    }
    const Vec2 bounds = environment_row_bounds(view, y);
    const float pdf = environment_texel_pdf(view, pmf, bounds);

    const float s = lerp(bounds.x, bounds.y, rest.y), c = 1.0f - s; // squares of sin, cos of theta / 2
    const bool is_south = y > view.height - 1 - y;
    const float sin_theta = 2.0f * safe_sqrt(s * c), cos_theta = is_south ? s - c : c - s;
    const float column = static_cast<float>(x) + rest.x;
    const float turns = column / static_cast<float>(view.width) - 0.5f - view.rotation_turns;
    float sin_longitude, cos_longitude;
    sin_cos_2pi(turns, sin_longitude, cos_longitude);
    sample.wi = {sin_theta * sin_longitude, cos_theta, -(sin_theta * cos_longitude)};
    sample.pdf = pdf;
    if (view.is_constant) {
        sample.radiance = view.constant;
    } else {
        const auto height = static_cast<float>(view.height);
        const float from_pole = 2.0f * kInvPi * height * atan2(sqrt(s), safe_sqrt(c));
        sample.radiance = environment_radiance_at(view, {column, is_south ? height - from_pole : from_pole});
    }
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
/// largest half float, whose overflow they are as a rule), each kind with one warning. An image whose pixels are all
/// equal, or no image, becomes a constant. Takes seconds for 10^8 pixels.
EnvironmentData build_environment_light(const Environment& environment, Messages& messages);

/// View of host memory; valid as long as the data is.
EnvironmentView view_of(const EnvironmentData& data);

} // namespace pertev
