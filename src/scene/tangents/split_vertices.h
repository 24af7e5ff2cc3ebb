#pragma once

// Splits the vertices of a mesh whose corners have different tangents.

#include <cstdint>
#include <span>
#include <vector>

#include "math/vec4.h"

namespace pertev {

struct SplitVertices {
    std::vector<uint32_t> indices;      // [corners] new vertices
    std::vector<uint32_t> copied_from;  // [added vertices] the old vertex that each copies; they follow the old ones
    std::vector<uint32_t> first_corner; // [old and added vertices] first corner that uses it, or kNoCornerShows
};

inline constexpr uint32_t kNoCornerShows = 0xffffffffu;

/// Splits vertices whose corners have different tangents. `indices` are [corners] of `vertex_count` vertices;
/// `tangents` are [corners]. The first tangent of a vertex keeps the vertex's number.
SplitVertices split_vertices(std::span<const uint32_t> indices, std::size_t vertex_count,
                             std::span<const Vec4> tangents);

} // namespace pertev
