#pragma once

// Splits the vertices of a mesh whose corners have tangents of their own.

#include <cstdint>
#include <span>
#include <vector>

#include "math/vec4.h"

namespace pertev {

struct SplitVertices {
    std::vector<uint32_t> indices;      // [corners] of the new vertices
    std::vector<uint32_t> copied_from;  // [vertices added] each a copy of that old one; they follow the old ones
    std::vector<uint32_t> first_corner; // [old and added vertices] that shows it, or kNoCornerShows
};

inline constexpr uint32_t kNoCornerShows = 0xffffffffu;

/// `indices`: [corners] of `vertex_count` vertices; `tangents`: [corners]. The first tangent of a vertex keeps its
/// number.
SplitVertices split_vertices(std::span<const uint32_t> indices, std::size_t vertex_count,
                             std::span<const Vec4> tangents);

} // namespace pertev
