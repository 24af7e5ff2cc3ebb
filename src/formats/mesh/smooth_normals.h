#pragma once

// Normals for smooth meshes without their own.

#include <vector>

#include "scene/mesh.h"

namespace pertev {

/// Returns the normals of the vertices: those of the triangles around them by the angles there. A vertex without a
/// triangle that has an area gets 0.
std::vector<Vec3> angle_weighted_normals(const Mesh& mesh);

} // namespace pertev
