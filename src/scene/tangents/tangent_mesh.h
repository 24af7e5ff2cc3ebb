#pragma once

// The input of MikkTSpace: triangles with a normal and a texture coordinate at each vertex. Each triangle has two
// directions along which its texture coordinates grow.
//
// Source: Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008, section 2.

#include <cstdint>
#include <span>

#include "math/scalar.h"
#include "math/vec2.h"
#include "math/vec3.h"

namespace pertev {

struct TangentMesh {
    std::span<const Vec3> positions, normals; // [vertices]; normals are unit
    std::span<const Vec2> uv;                 // [vertices]
    std::span<const uint32_t> indices;        // [3 * triangles]; indices of these vertices

    std::size_t corner_count() const { return indices.size(); }
    Vec3 position(std::size_t corner) const { return positions[indices[corner]]; }
    Vec3 normal(std::size_t corner) const { return normals[indices[corner]]; }
    Vec2 coordinate(std::size_t corner) const { return uv[indices[corner]]; }
};

/// The corner of a triangle that follows `corner`, and the one before it.
inline std::size_t next_corner(std::size_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }
inline std::size_t previous_corner(std::size_t corner) { return corner % 3 == 0 ? corner + 2 : corner - 1; }

struct UvDirections {
    Vec3 along_u, along_v;     // unit; zero if the coordinates define no direction
    bool is_counter_clockwise; // orientation in the plane of (u, v), u right and v up
    bool is_known;             // along_u and along_v have a length
};

/// Returns whether a number is not zero; numbers below the least normal float count as zero.
inline bool is_not_zero(float x) { return abs(x) > 0x1p-126f; }

/// Returns the derivatives of the position by u and by v, each scaled to length 1.
inline UvDirections uv_directions(const TangentMesh& mesh, std::size_t triangle) {
    const std::size_t a = 3 * triangle;
    const Vec3 ab = mesh.position(a + 1) - mesh.position(a), ac = mesh.position(a + 2) - mesh.position(a);
    const Vec2 uv_ab = mesh.coordinate(a + 1) - mesh.coordinate(a), uv_ac = mesh.coordinate(a + 2) - mesh.coordinate(a);
    const float area = uv_ab.x * uv_ac.y - uv_ab.y * uv_ac.x; // twice the signed area
    UvDirections result = {.along_u = {}, .along_v = {}, .is_counter_clockwise = area > 0, .is_known = false};
    if (!is_not_zero(area)) return result;
    const Vec3 by_u = uv_ac.y * ab - uv_ab.y * ac, by_v = uv_ab.x * ac - uv_ac.x * ab;
    const float length_u = length(by_u), length_v = length(by_v), sign = area > 0 ? 1.0f : -1.0f;
    if (is_not_zero(length_u)) result.along_u = (sign / length_u) * by_u;
    if (is_not_zero(length_v)) result.along_v = (sign / length_v) * by_v;
    result.is_known = is_not_zero(length_u / abs(area)) && is_not_zero(length_v / abs(area));
    return result;
}

} // namespace pertev
