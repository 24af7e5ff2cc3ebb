#pragma once

// Opacity micromap of a triangle: the triangle is divided into 4^level equal micro-triangles, and two bits each state
// whether all of it is transparent, all of it is opaque, or its textures must be evaluated. It never contradicts the
// textures (device_scene/classify_opacity.h), so that no picture depends on it.
//
// Source: Gruen, Benthin and Woop, "Sub-triangle opacity masks for faster ray tracing of transparent objects", 2020;
// VK_EXT_opacity_micromap is the equivalent on cards with ray-tracing cores.

#include <cstdint>

#include "base/host_device.h"
#include "math/scalar.h"
#include "math/vec2.h"

namespace pertev {

enum class Opacity : uint32_t { Unknown = 0, Transparent = 1, Opaque = 2 };

/// Limits of the subdivision level. A word has 16 micro-triangles, so a triangle has at least one word.
inline constexpr uint32_t kMinMicroLevel = 2, kMaxMicroLevel = 9, kMicroTrianglesPerWord = 16;

HD constexpr uint32_t micro_triangles(uint32_t level) { return 1u << 2 * level; }
HD constexpr uint32_t words_per_triangle(uint32_t level) { return micro_triangles(level) / kMicroTrianglesPerWord; }

/// Micromaps of the triangles of one mesh with one material.
struct OpacityMicromapView {
    const uint32_t* states; // [triangles * words_per_triangle(level)]; null if there are none
    uint32_t level;         // [kMinMicroLevel, kMaxMicroLevel]
};

/// Maximum distance, in barycentrics, by which rounding may move a position outside its triangle.
inline constexpr float kMaxBeside = 0x1p-22f;

/// A micro-triangle: cell (column, row) of 2^level per side, counted along u and v, and which half of it.
struct MicroTriangle {
    uint32_t column, row;
    bool is_upper; // beyond the cell's diagonal
};

/// Index of a micro-triangle: by rows, lower and upper alternating. A row has two fewer than the previous one.
HD inline uint32_t micro_index(uint32_t level, MicroTriangle t) {
    return t.row * (2 * (1u << level) - t.row) + 2 * t.column + (t.is_upper ? 1 : 0);
}

/// Inverse of micro_index; `index` < micro_triangles(level).
HD inline MicroTriangle micro_triangle_at(uint32_t level, uint32_t index) {
    uint32_t row = 0;
    while (index >= micro_index(level, {0, row + 1, false})) ++row;
    index -= micro_index(level, {0, row, false});
    return {index / 2, row, index % 2 != 0};
}

/// The micro-triangle that contains (u, v), or an adjacent one if rounding has moved (u, v) outside the triangle or
/// onto an edge.
HD inline MicroTriangle micro_triangle_of(uint32_t level, float u, float v) {
    const int last = (1 << level) - 1;
    const auto side = static_cast<float>(last + 1);
    const int column = to_int(u * side, 0, last), row = to_int(v * side, 0, last);
    const bool is_upper = u * side - static_cast<float>(column) + (v * side - static_cast<float>(row)) > 1;
    // On the triangle's long side cells are halves.
    if (column + row >= last) return {static_cast<uint32_t>(last - row), static_cast<uint32_t>(row), false};
    return {static_cast<uint32_t>(column), static_cast<uint32_t>(row), is_upper};
}

/// Corners of a micro-triangle as barycentrics (u, v).
struct MicroCorners {
    Vec2 at[3];
};
HD inline MicroCorners corners_of(uint32_t level, MicroTriangle t) {
    const float size = 1.0f / static_cast<float>(1u << level);
    const float u = static_cast<float>(t.column) * size, v = static_cast<float>(t.row) * size;
    const Vec2 first = t.is_upper ? Vec2{u + size, v + size} : Vec2{u, v};
    return {{first, {u + size, v}, {u, v + size}}};
}

/// Opacity at (u, v) on triangle `primitive`; unknown if it is farther outside the triangle than a ray's hit can be.
HD inline Opacity opacity_at(const OpacityMicromapView& map, uint32_t primitive, float u, float v) {
    if (!(min(u, v) >= -kMaxBeside && u + v <= 1 + kMaxBeside)) return Opacity::Unknown;
    const uint32_t index = micro_index(map.level, micro_triangle_of(map.level, u, v));
    const uint64_t word = uint64_t(primitive) * words_per_triangle(map.level) + index / kMicroTrianglesPerWord;
    return static_cast<Opacity>(map.states[word] >> index % kMicroTrianglesPerWord * 2 & 3u);
}

/// Opacity of a candidate as far as micromaps determine it. `maps` is [instance], or null if there are none.
HD inline Opacity known_opacity(const OpacityMicromapView* maps, uint32_t instance, uint32_t primitive, float u,
                                float v) {
    if (maps == nullptr) return Opacity::Unknown;
    const OpacityMicromapView map = maps[instance];
    return map.states != nullptr ? opacity_at(map, primitive, u, v) : Opacity::Unknown;
}

} // namespace pertev
