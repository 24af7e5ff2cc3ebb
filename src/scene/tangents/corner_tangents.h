#pragma once

// MikkTSpace's tangent at a corner is a mean over the triangles of the corner's group: each adds its direction of
// growing u, projected into the plane across the normal and weighted by the triangle's angle at that vertex.
//
// Source: Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008, sections 2 and 4.

#include <vector>

#include "math/vec4.h"
#include "scene/tangents/tangent_groups.h"

namespace pertev {

/// Returns a unit tangent for each corner. Its w is glTF's handedness: the bitangent cross(normal, tangent) * w
/// points against growing v. A corner without a direction gets (1, 0, 0, 1). `groups` belong to a mesh with these
/// indices and texture coordinates; its vertices may have moved since.
std::vector<Vec4> corner_tangents(const TangentMesh& mesh, const TangentGroups& groups);

} // namespace pertev
