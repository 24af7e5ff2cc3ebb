#pragma once

// Tabulated energy loss of single-scattering GGX microfacets, and the lobes that compensate it.
//
// Source: Kulla & Conty, "Revisiting Physically Based Shading at Imageworks", SIGGRAPH course 2017.
// With the lost fraction e(mu) for a direction of cosine mu, and its average e_avg = 2 int e(mu) mu dmu, the lobe
// e(o) e(i) / (pi e_avg) is reciprocal and carries e(o), exactly the missing energy, for any e whose interpolated
// form has the average e_avg. Interpolation is linear; where the tables are inexact, they err towards too little
// light. Axes: x = a / (a + b), a^2 = mu, b^2 = alpha (1 - mu), because e is a function of mu / alpha where both are
// small; roughness sqrt(alpha) from alpha = 1e-3 to 1; sqrt((ior - 1) / (ior + 1)) for ior from 1.1 to 3.

#include <type_traits>

#include "base/host_device.h"
#include "math/rgb.h"
#include "math/scalar.h"
#include "shading/lobes/beckmann_table_data.h"
#include "shading/lobes/energy_table_data.h"
#include "shading/lobes/fresnel.h"

namespace pertev {

namespace energy_table {

template <class T>
struct CellOf {
    WordOf<T> node; // lower node
    T fraction;     // [0, 1] towards the next
};
using Cell = CellOf<float>;

/// Cell of `x` in [0, 1] along an axis with `nodes` nodes; clamped.
template <class T>
HD inline CellOf<T> make_cell(T x, int nodes) {
    const T p = clamp(x, 0.0f, 1.0f) * static_cast<float>(nodes - 1);
    const T lower = floor(clamp(p, 0.0f, static_cast<float>(nodes - 2)));
    return {truncate_to_word(lower), p - lower};
}

template <class T>
HD inline CellOf<T> mu_cell(T mu, T alpha, int nodes = kMuNodes) {
    const T root = sqrt(mu);
    CellOf<T> cell = make_cell(root / (root + safe_sqrt(alpha * (1.0f - mu))), nodes);
    const MaskOf<T> is_first = cell.node == 0u; // the curves are linear in mu there
    cell.fraction = select(is_first, cell.fraction * cell.fraction, cell.fraction);
    return cell;
}
/// Position between the least roughness and 1, in [0, 1].
template <class T>
HD inline T roughness_position(T alpha) {
    constexpr float lowest = 0.031622776f; // sqrt(kAlphaMin)
    return (sqrt(alpha) - lowest) * (1.0f / (1.0f - lowest));
}
template <class T>
HD inline CellOf<T> roughness_cell(T alpha, int nodes = kRoughnessNodes) {
    return make_cell(roughness_position(alpha), nodes);
}
/// Cell of the averages, which change fastest at the least roughness.
template <class T>
HD inline CellOf<T> average_cell(T alpha, int nodes = kAverageNodes) {
    return make_cell(safe_sqrt(roughness_position(alpha)), nodes);
}
HD inline Cell ior_cell(float ior, int nodes = kIorNodes) {
    constexpr float lowest = 0.21821789f, highest = 0.70710678f; // values for kIorMin and kIorMax
    return make_cell((safe_sqrt((ior - 1.0f) / (ior + 1.0f)) - lowest) * (1.0f / (highest - lowest)), nodes);
}

inline constexpr float kUnit = 1.0f / 65535.0f;

/// Value at node `i` of the flattened table; for several numbers at once of each.
template <class T, class Table>
HD inline T value_at(Table table, WordOf<T> i) {
    if constexpr (std::is_same_v<T, float>) {
        return static_cast<float>(table(static_cast<int>(i)));
    } else {
        alignas(64) float lanes[T::kLanes];
        for (uint32_t lane = 0; lane < T::kLanes; ++lane) lanes[lane] = value_at<float>(table, i[lane]);
        return T::load(lanes);
    }
}
/// Interpolates along the last axis, from node `i` of the flattened table.
template <class Table, class T>
HD inline T along(Table table, std::type_identity_t<WordOf<T>> i, T fraction) {
    return lerp(value_at<T>(table, i), value_at<T>(table, i + 1u), fraction);
}
/// Interpolates along the last two axes.
template <class Table, class T>
HD inline T along(Table table, uint32_t first, CellOf<T> row, CellOf<T> column, uint32_t columns) {
    const WordOf<T> i = row.node * columns + column.node + first;
    return lerp(along(table, i, column.fraction), along(table, i + columns, column.fraction), row.fraction);
}

} // namespace energy_table

/// Fraction lost by a reflector with F = 1, seen at cosine `mu` in [0, 1]. alpha is in [kSmoothAlpha, 1], here and
/// below.
template <class T>
HD inline T metal_lost(T mu, T alpha) {
    using namespace energy_table;
    return kUnit *
           along([](int i) { return metal_lost_at(i); }, 0, roughness_cell(alpha), mu_cell(mu, alpha), kMuNodes);
}
/// Average loss, 2 int metal_lost(mu) mu dmu.
template <class T>
HD inline T metal_average_lost(T alpha) {
    using namespace energy_table;
    const CellOf<T> c = average_cell(alpha);
    return alpha * along([](int i) { return metal_average_lost_at(i); }, c.node, c.fraction);
}

/// Average of (1 - cos)^5, Schlick's weight, over the light that a reflector with F = 1 reflects at cosine `mu`.
template <class T>
HD inline T metal_schlick(T mu, T alpha) {
    using namespace energy_table;
    const T beyond =
        along([](int i) { return metal_schlick_at(i); }, 0, roughness_cell(alpha), mu_cell(mu, alpha), kMuNodes);
    return max(schlick_weight(mu) + (2.0f * kUnit * beyond - 1.0f), T(0.0f));
}
/// Average of that weight, 2 int (1 - metal_lost(mu)) metal_schlick(mu) mu dmu.
template <class T>
HD inline T metal_average_schlick(T alpha) {
    using namespace energy_table;
    const CellOf<T> c = average_cell(alpha);
    return along([](int i) { return metal_average_schlick_at(i); }, c.node, c.fraction);
}

/// metal_lost(), metal_average_lost() and metal_schlick() of Beckmann's microfacets.
HD inline float beckmann_lost(float mu, float alpha) {
    using namespace energy_table;
    return kUnit * along([](int i) { return beckmann_table::beckmann_lost_at(i); }, 0, roughness_cell(alpha),
                         mu_cell(mu, alpha), kMuNodes);
}
HD inline float beckmann_average_lost(float alpha) {
    using namespace energy_table;
    const Cell c = average_cell(alpha);
    return alpha * along([](int i) { return beckmann_table::beckmann_average_lost_at(i); }, c.node, c.fraction);
}
HD inline float beckmann_schlick(float mu, float alpha) {
    using namespace energy_table;
    const float beyond = along([](int i) { return beckmann_table::beckmann_schlick_at(i); }, 0, roughness_cell(alpha),
                               mu_cell(mu, alpha), kMuNodes);
    return max(schlick_weight(mu) + (2.0f * kUnit * beyond - 1.0f), 0.0f);
}

/// Fraction lost by a dielectric, reflection and refraction together, seen at cosine `mu`. `eta` is the index of the
/// far side over that of the near side: in [kIorMin, kIorMax] from outside, in [1 / kIorMax, 1 / kIorMin] from
/// inside.
HD inline float glass_lost(float mu, float alpha, float eta) {
    using namespace energy_table;
    const Cell ior = ior_cell(eta > 1 ? eta : 1.0f / eta), row = roughness_cell(alpha), column = mu_cell(mu, alpha);
    constexpr int stride = kRoughnessNodes * kMuNodes;
    const uint32_t first = ((eta > 1 ? 0 : kIorNodes) + ior.node) * stride;
    const auto table = [](int i) { return glass_lost_at(i); };
    return kUnit * lerp(along(table, first, row, column, kMuNodes), along(table, first + stride, row, column, kMuNodes),
                        ior.fraction);
}
/// Average loss, 2 int glass_lost(mu) mu dmu.
HD inline float glass_average_lost(float alpha, float eta) {
    using namespace energy_table;
    const uint32_t first = (eta > 1 ? 0 : kIorNodes) * kAverageNodes;
    return alpha * along([](int i) { return glass_average_lost_at(i); }, first, ior_cell(eta > 1 ? eta : 1.0f / eta),
                         average_cell(alpha), kAverageNodes);
}

/// glass_lost() and glass_average_lost() of Beckmann's microfacets.
HD inline float beckmann_glass_lost(float mu, float alpha, float eta) {
    using namespace energy_table;
    constexpr int iors = beckmann_table::kIorNodes, rows = beckmann_table::kRoughnessNodes, stride = rows * kMuNodes;
    const Cell ior = ior_cell(eta > 1 ? eta : 1.0f / eta, iors), row = roughness_cell(alpha, rows),
               column = mu_cell(mu, alpha);
    const uint32_t first = ((eta > 1 ? 0 : iors) + ior.node) * stride;
    const auto table = [](int i) { return beckmann_table::beckmann_glass_lost_at(i); };
    return kUnit * lerp(along(table, first, row, column, kMuNodes), along(table, first + stride, row, column, kMuNodes),
                        ior.fraction);
}
HD inline float beckmann_average_glass_lost(float alpha, float eta) {
    using namespace energy_table;
    constexpr int iors = beckmann_table::kIorNodes;
    const uint32_t first = (eta > 1 ? 0 : iors) * kAverageNodes;
    return alpha * along([](int i) { return beckmann_table::beckmann_average_glass_lost_at(i); }, first,
                         ior_cell(eta > 1 ? eta : 1.0f / eta, iors), average_cell(alpha), kAverageNodes);
}

/// Colour of the light that is returned after several bounces off facets with average reflectance `f_average`, if a
/// bounce loses `average_lost` of it to the next.
template <class T>
HD inline T multiple_scattering_tint(T f_average, T average_lost) {
    return f_average * f_average * (1.0f - average_lost) / (1.0f - f_average * average_lost);
}
template <class T>
HD inline RgbOf<T> multiple_scattering_tint(RgbOf<T> f_average, T average_lost) {
    return {multiple_scattering_tint(f_average.r, average_lost), multiple_scattering_tint(f_average.g, average_lost),
            multiple_scattering_tint(f_average.b, average_lost)};
}

} // namespace pertev
