#pragma once

// The tangent at each corner of a mesh, as MikkTSpace makes it: the directions of growing u of the triangles in the
// corner's group, laid across the normal and weighted by the triangles' angles at that vertex.
//
// Source: Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008, sections 2 and 4.

#include <vector>

#include "math/vec4.h"
#include "scene/tangents/tangent_groups.h"

namespace pertev {

/// For each corner a unit tangent and, in w, the handedness as glTF has it: the bitangent cross(normal, tangent) * w
/// points against growing v. A corner that no direction is known for gets (1, 0, 0, 1). `groups`: of a mesh with these
/// indices and texture coordinates; its vertices may have moved since.
std::vector<Vec4> corner_tangents(const TangentMesh& mesh, const TangentGroups& groups);

} // namespace pertev
