#pragma once

// validate()'s part for one mesh: drops triangles that no ray could hit soundly, makes every number finite.

#include <cstdint>
#include <string>

#include "scene/mesh.h"
#include "scene/mesh_shape.h"

namespace pertev {

/// How many things were repaired.
struct MeshRepairs {
    uint64_t not_finite = 0, too_far = 0, without_area = 0; // triangles dropped
    uint64_t normals = 0, tangents = 0, texture_coordinates = 0, colors = 0;

    MeshRepairs& operator+=(const MeshRepairs& other);
};

/// After it: indices in range, positions finite and within kMaxCoordinate, normals and tangents unit, texture
/// coordinates finite, colours in [0, 1], no triangle without area, but for a mesh that is `reshaped` over time: such
/// a triangle may have one later. Vertices keep their numbers; one that is not finite
/// or too far is then used by no triangle and set to 0. Throws Error(BadInput or OverLimit) that starts with `of`.
MeshRepairs repair_mesh(Mesh& mesh, bool reshaped, const std::string& of);

/// What shape_mesh reads of the shape of `mesh`, of a scene whose nodes and skins are valid: every array has its size,
/// joints are in range, every number is finite, normals and tangents have a direction. Throws Error(BadInput) that
/// starts with `of`.
MeshRepairs repair_shape(MeshShape& shape, const Mesh& mesh, std::size_t joint_count, const std::string& of);

} // namespace pertev
