#pragma once

// The part of validate() for one mesh: removes triangles that rays cannot hit robustly, and makes every number
// finite.

#include <cstdint>
#include <string>

#include "base/error.h"
#include "scene/mesh.h"
#include "scene/mesh_shape.h"

namespace pertev {

/// Numbers of repairs.
struct MeshRepairs {
    uint64_t not_finite = 0, too_far = 0, without_area = 0; // triangles removed
    uint64_t normals = 0, tangents = 0, texture_coordinates = 0, colors = 0;

    MeshRepairs& operator+=(const MeshRepairs& other);
};

/// Names a mesh in errors.
struct MeshName {
    std::string file, name; // "a.gltf", "/meshes/0 floor"
    Error error(ErrorCode code, const std::string& why) const;
};

/// Repairs a mesh. Afterwards indices are in range, positions finite and within kMaxCoordinate, normals and tangents
/// unit, texture coordinates finite and colours in [0, 1], and no triangle lacks area, except in a mesh that is
/// `reshaped` over time, where it may have one later. Vertices keep their numbers; one that is not finite or too far
/// is set to 0, and no triangle uses it. Throws Error(BadInput or OverLimit) about `of`.
MeshRepairs repair_mesh(Mesh& mesh, bool reshaped, const MeshName& of);

/// Repairs the data of a shape that shape_mesh reads, in a scene whose nodes and skins are valid: every array has its
/// size, joints are in range, every number is finite, normals and tangents have a direction. Throws Error(BadInput)
/// about `of`.
MeshRepairs repair_shape(MeshShape& shape, const Mesh& mesh, std::size_t joint_count, const MeshName& of);

} // namespace pertev
