#pragma once

// Tabulated energy loss of single-scattering microfacets that are stretched, GGX or Beckmann, as energy_tables.h has it
// of isotropic ones: the loss depends on the view's azimuth too.
//
// Axes, with the widths x >= y and the view's w: mu as in energy_tables.h, with the width sqrt(x^2 cos^2 + y^2 sin^2)
// of the azimuth, by which the view is masked; b / (a + b), a^2 = x w.x^2, b^2 = y w.y^2, which resolves the azimuths
// near both tangents; x from 1e-3 to 1; sqrt(y / x). Averages: sqrt(x) and sqrt(y / x).
//
// Glass of GGX loses what an even surface of the width stretched_even_width() does, times what metal loses over what
// that surface's metal does, times a factor of few nodes: over the index as in energy_tables.h, sqrt(x), sqrt(y / x),
// the azimuth |w.y| / (|w.x| + |w.y|) and sqrt(mu), of both sides.

#include "math/vec3.h"
#include "shading/lobes/energy_tables.h"
#include "shading/lobes/stretched_table_data.h"

namespace pertev {

namespace stretched_table {

/// Interpolates `table` for a view `w` in the frame of the widths.
template <class Table>
HD inline float at_view(Table table, Vec3 w, float x, float y) {
    using namespace energy_table;
    const float x2 = w.x * w.x, y2 = w.y * w.y, mu = min(abs(w.z), 1.0f), sine2 = x2 + y2;
    const float alpha = sine2 > 0 ? sqrt((x * x * x2 + y * y * y2) / sine2) : x;
    const float a = sqrt(x * x2), b = sqrt(y * y2), root = sqrt(mu);
    Cell column = make_cell(root / (root + safe_sqrt(alpha * (1.0f - mu))), kMuNodes);
    if (column.node == 0) column.fraction *= column.fraction; // the curves are linear in mu there
    const Cell row = make_cell(a + b > 0 ? b / (a + b) : 0.0f, kAzimuthNodes);
    Cell width = make_cell((x - kWidthMin) * (1.0f / (1.0f - kWidthMin)), kWidthNodes);
    if (width.node == 0) width.fraction *= width.fraction; // far from the horizon the loss begins with the square
    const Cell ratio = make_cell(sqrt(y / x), kRatioNodes);
    constexpr uint32_t stride = kAzimuthNodes * kMuNodes;
    float sum = 0;
    for (uint32_t corner = 0; corner < 4; ++corner) {
        const uint32_t first = ((ratio.node + (corner >> 1)) * kWidthNodes + width.node + (corner & 1u)) * stride;
        const float part = ((corner & 1u) != 0 ? width.fraction : 1.0f - width.fraction) *
                           (corner > 1 ? ratio.fraction : 1.0f - ratio.fraction);
        sum += part * along(table, first, row, column, kMuNodes);
    }
    return kUnit * sum;
}
template <class Table>
HD inline float average_at(Table table, float x, float y) {
    using namespace energy_table;
    constexpr float least = 0.0316227766f; // the root of kWidthMin
    const Cell width = make_cell((sqrt(x) - least) * (1.0f / (1.0f - least)), kAverageWidthNodes);
    const Cell ratio = make_cell(sqrt(y / x), kAverageRatioNodes);
    return x * along(table, 0, ratio, width, kAverageWidthNodes);
}

} // namespace stretched_table

/// Fraction lost by a reflector with F = 1 of widths x and y, in [kSmoothAlpha, 1], seen from `w` in their frame.
HD_CALL inline float stretched_lost(Vec3 w, float x, float y, bool is_beckmann) {
    using namespace stretched_table;
    if (y > x) w = {w.y, w.x, w.z};
    return at_view([is_beckmann](int i) { return is_beckmann ? stretched_beckmann_lost_at(i) : stretched_lost_at(i); },
                   w, max(x, y), min(x, y));
}
/// Average loss, the integral of stretched_lost(w) by the cosine over pi.
HD_CALL inline float stretched_average_lost(float x, float y, bool is_beckmann) {
    using namespace stretched_table;
    return average_at(
        [is_beckmann](int i) {
            return is_beckmann ? stretched_beckmann_average_lost_at(i) : stretched_average_lost_at(i);
        },
        max(x, y), min(x, y));
}

/// Width of the even GGX metal that loses on average about as much as one of widths x >= y.
HD inline float stretched_even_width(float x, float y) {
    const float ratio = sqrt(y / x);
    return x * (0.67f + ratio * (0.099f + 0.231f * ratio));
}
/// glass_lost() of stretched GGX microfacets, seen from `w` in their frame, and glass_average_lost().
HD_CALL inline float stretched_glass_lost(Vec3 w, float x, float y, float eta) {
    using namespace energy_table;
    using namespace stretched_table;
    if (y > x) {
        w = {w.y, w.x, w.z};
        const float narrow = x;
        x = y;
        y = narrow;
    }
    const float mu = min(abs(w.z), 1.0f), even = max(stretched_even_width(x, y), kAlphaMin);
    const float a = abs(w.x), b = abs(w.y);
    const Cell ior = ior_cell(eta > 1 ? eta : 1.0f / eta, kGlassIorNodes),
               width = make_cell(roughness_position(x), kGlassWidthNodes),
               ratio = make_cell(sqrt(y / x), kGlassRatioNodes),
               row = make_cell(a + b > 0 ? b / (a + b) : 0.0f, kGlassAzimuthNodes),
               column = make_cell(sqrt(mu), kGlassMuNodes);
    constexpr uint32_t stride = kGlassAzimuthNodes * kGlassMuNodes;
    float factor = 0;
    for (uint32_t corner = 0; corner < 8; ++corner) {
        const uint32_t i = ior.node + (corner & 1u), j = width.node + (corner >> 1 & 1u),
                       k = ratio.node + (corner >> 2);
        const float part = ((corner & 1u) != 0 ? ior.fraction : 1.0f - ior.fraction) *
                           ((corner >> 1 & 1u) != 0 ? width.fraction : 1.0f - width.fraction) *
                           ((corner >> 2) != 0 ? ratio.fraction : 1.0f - ratio.fraction);
        const uint32_t first =
            ((((eta > 1 ? 0u : kGlassIorNodes) + i) * kGlassWidthNodes + j) * kGlassRatioNodes + k) * stride;
        factor += part * along([](int at) { return stretched_glass_factor_at(at); }, first, row, column, kGlassMuNodes);
    }
    const float metal = stretched_lost(w, x, y, false) / max(metal_lost(mu, even), 1e-9f);
    const float horizon =
        min(0.97f + 1.5f * mu, 1.0f); // interpolation between the first cosines is too much by so much
    return min(kGlassUnit * factor * horizon * (glass_lost(mu, even, eta) * metal), 1.0f);
}
HD_CALL inline float stretched_average_glass_lost(float x, float y, float eta) {
    using namespace energy_table;
    using namespace stretched_table;
    const Cell ior = ior_cell(eta > 1 ? eta : 1.0f / eta, kGlassAverageIorNodes),
               width = make_cell(roughness_position(max(x, y)), kGlassAverageWidthNodes),
               ratio = make_cell(sqrt(min(x, y) / max(x, y)), kGlassAverageRatioNodes);
    constexpr uint32_t stride = kGlassAverageWidthNodes * kGlassAverageRatioNodes;
    const uint32_t first = ((eta > 1 ? 0u : kGlassAverageIorNodes) + ior.node) * stride;
    const auto table = [](int i) { return stretched_glass_average_at(i); };
    return kUnit * lerp(along(table, first, width, ratio, kGlassAverageRatioNodes),
                        along(table, first + stride, width, ratio, kGlassAverageRatioNodes), ior.fraction);
}

} // namespace pertev
