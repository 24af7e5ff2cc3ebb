#pragma once

// An opacity micromap of a triangle: the triangle is cut into 4^level equal micro-triangles, and of each two bits say
// whether all of it lets rays pass, all of it stops them, or its textures must be asked. It never answers otherwise
// than the textures do (device_scene/classify_opacity.h), so that no picture knows whether it was there.
//
// Source: Gruen, Benthin and Woop, "Sub-triangle opacity masks for faster ray tracing of transparent objects", 2020;
// VK_EXT_opacity_micromap has the same on cards with ray-tracing cores.

#include <cstdint>

#include "base/host_device.h"
#include "math/scalar.h"
#include "math/vec2.h"

namespace pertev {

enum class Opacity : uint32_t { Unknown = 0, Transparent = 1, Opaque = 2 };

/// A word has 16 micro-triangles, so a triangle has a word at least.
inline constexpr uint32_t kLeastMicroLevel = 2, kMostMicroLevel = 9, kMicroTrianglesPerWord = 16;

HD constexpr uint32_t micro_triangles(uint32_t level) { return 1u << 2 * level; }
HD constexpr uint32_t words_per_triangle(uint32_t level) { return micro_triangles(level) / kMicroTrianglesPerWord; }

/// The micromaps of the triangles of one mesh under one material.
struct OpacityMicromapView {
    const uint32_t* states; // [triangles * words_per_triangle(level)]; null: none
    uint32_t level;         // [kLeastMicroLevel, kMostMicroLevel]
};

/// How far rounding may put a place beside its triangle, in barycentrics.
inline constexpr float kMostBeside = 0x1p-22f;

/// A micro-triangle: cell (column, row) of 2^level a side, counted along u and v, and which half of it.
struct MicroTriangle {
    uint32_t column, row;
    bool is_upper; // beyond the cell's diagonal
};

/// Their order: by rows, lower and upper in turns. A row has two fewer than the row before.
HD inline uint32_t micro_index(uint32_t level, MicroTriangle t) {
    return t.row * (2 * (1u << level) - t.row) + 2 * t.column + (t.is_upper ? 1 : 0);
}

/// `index` < micro_triangles(level).
HD inline MicroTriangle micro_triangle_at(uint32_t level, uint32_t index) {
    uint32_t row = 0;
    while (index >= micro_index(level, {0, row + 1, false})) ++row;
    index -= micro_index(level, {0, row, false});
    return {index / 2, row, index % 2 != 0};
}

/// The one that holds (u, v), or, where rounding has put that beside the triangle or on an edge, one beside it.
HD inline MicroTriangle micro_triangle_of(uint32_t level, float u, float v) {
    const int last = (1 << level) - 1;
    const auto side = static_cast<float>(last + 1);
    const int column = to_int(u * side, 0, last), row = to_int(v * side, 0, last);
    const bool is_upper = u * side - static_cast<float>(column) + (v * side - static_cast<float>(row)) > 1;
    // On the triangle's long side cells are halves.
    if (column + row >= last) return {static_cast<uint32_t>(last - row), static_cast<uint32_t>(row), false};
    return {static_cast<uint32_t>(column), static_cast<uint32_t>(row), is_upper};
}

/// Its corners, barycentrics (u, v).
struct MicroCorners {
    Vec2 at[3];
};
HD inline MicroCorners corners_of(uint32_t level, MicroTriangle t) {
    const float size = 1.0f / static_cast<float>(1u << level);
    const float u = static_cast<float>(t.column) * size, v = static_cast<float>(t.row) * size;
    const Vec2 first = t.is_upper ? Vec2{u + size, v + size} : Vec2{u, v};
    return {{first, {u + size, v}, {u, v + size}}};
}

/// At (u, v) on triangle `primitive`. Beside the triangle by more than a ray's hit can be, nothing is known.
HD inline Opacity opacity_at(const OpacityMicromapView& map, uint32_t primitive, float u, float v) {
    if (!(min(u, v) >= -kMostBeside && u + v <= 1 + kMostBeside)) return Opacity::Unknown;
    const uint32_t index = micro_index(map.level, micro_triangle_of(map.level, u, v));
    const uint64_t word = uint64_t(primitive) * words_per_triangle(map.level) + index / kMicroTrianglesPerWord;
    return static_cast<Opacity>(map.states[word] >> index % kMicroTrianglesPerWord * 2 & 3u);
}

/// What is known of a candidate of an instance. `maps`: one each; null: none.
HD inline Opacity known_opacity(const OpacityMicromapView* maps, uint32_t instance, uint32_t primitive, float u,
                                float v) {
    if (maps == nullptr) return Opacity::Unknown;
    const OpacityMicromapView map = maps[instance];
    return map.states != nullptr ? opacity_at(map, primitive, u, v) : Opacity::Unknown;
}

} // namespace pertev
