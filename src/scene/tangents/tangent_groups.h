#pragma once

// MikkTSpace puts the corners of a mesh into groups that share a tangent. The corners of a group meet in one vertex
// (equal position, normal and texture coordinate), their triangles are connected there by edges between two such
// vertices, and their texture coordinates have one orientation. Thus a seam, a hard edge and the axis of a mirrored
// texture each end a group.
//
// Source: Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008, chapter 4. His library mikktspace adds two
// rules for degenerate triangles: one with two equal positions belongs to no group and has no neighbours; one whose
// texture coordinates have no direction joins the first group that reaches it, and adds nothing to its tangent.

#include <cstdint>
#include <span>
#include <vector>

#include "scene/tangents/tangent_mesh.h"

namespace pertev {

inline constexpr uint32_t kNoTangentGroup = 0xffffffffu;

struct BorrowedTangent {
    uint32_t corner, from;
};

struct TangentGroups {
    std::vector<uint32_t> group;           // [corners] or kNoTangentGroup
    std::vector<BorrowedTangent> borrowed; // corners of triangles without area, and corners of others at their
                                           // vertices

    // By group:
    std::vector<uint32_t> first;               // [groups + 1] index into `corners`
    std::vector<uint32_t> corners;             // one group after the other, ascending within each
    std::vector<uint8_t> is_counter_clockwise; // [groups], as in UvDirections

    std::size_t count() const { return is_counter_clockwise.size(); }
    std::span<const uint32_t> corners_of(std::size_t i) const {
        return std::span(corners).subspan(first[i], first[i + 1] - first[i]);
    }
};

/// Makes the groups of a mesh, in time proportional to the corners times the logarithm of the number that meet in a
/// vertex.
TangentGroups make_tangent_groups(const TangentMesh& mesh);

} // namespace pertev
