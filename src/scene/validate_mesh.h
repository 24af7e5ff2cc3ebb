#pragma once

// validate()'s part for one mesh: drops triangles that no ray could hit soundly, makes every number finite.

#include <cstdint>
#include <string>

#include "scene/mesh.h"

namespace pertev {

/// How many things were repaired.
struct MeshRepairs {
    uint64_t not_finite = 0, without_area = 0; // triangles dropped
    uint64_t normals = 0, tangents = 0, texture_coordinates = 0, colors = 0;

    MeshRepairs& operator+=(const MeshRepairs& other);
};

/// After it: indices in range, positions finite and within kMaxCoordinate, normals and tangents unit, texture
/// coordinates finite, colours in [0, 1], no triangle without area. Vertices keep their numbers; one that is not finite
/// is then used by no triangle and set to 0. Throws Error(BadInput or OverLimit) that starts with `of`.
MeshRepairs repair_mesh(Mesh& mesh, const std::string& of);

/// `v` at unit length, for any finite length but 0, else not finite.
Vec3 normalize_safely(Vec3 v);

} // namespace pertev
