#pragma once

// The vertices of a mesh that morph targets and a skin move: at rest and at every other time by the same function.

#include <span>
#include <vector>

#include "scene/mesh.h"
#include "scene/mesh_shape.h"
#include "scene/scene.h"

namespace pertev {

/// World from mesh space, one a joint. `world_from_node`: of all nodes.
std::vector<Transform> joint_transforms(const Skin& skin, std::span<const Transform> world_from_node);

/// Writes the positions, normals (unit) and tangents (unit, with their handedness) of `mesh`, which has the vertices
/// and triangles of `shape`. `morph_weights`: by target, those past the end are 0; `joints`: joint_transforms of its
/// skin, empty without one. Where the joints turn most of the vertices that they move inside out, as a mirroring does,
/// each triangle is wound the other way, so that its front stays the same side of it. Returns whether the triangles are
/// wound otherwise than before.
bool shape_mesh(MeshShape& shape, std::span<const float> morph_weights, std::span<const Transform> joints, Mesh& mesh);

/// Writes the vertices at rest of the meshes of `shapes`, which belong to `scene`; its nodes and skins are valid.
void shape_at_rest(Scene& scene, std::span<MeshShape* const> shapes);

} // namespace pertev
