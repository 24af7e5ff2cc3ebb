#pragma once

// Vertices of a mesh with morph targets and a skin, at rest and at any time by the same function.

#include <span>
#include <vector>

#include "scene/mesh.h"
#include "scene/mesh_shape.h"
#include "scene/scene.h"

namespace pertev {

/// World-from-mesh transform of each joint. `world_from_node`: [node].
std::vector<Transform> joint_transforms(const Skin& skin, std::span<const Transform> world_from_node);

/// Writes the positions, normals (unit) and tangents (unit, with handedness) of `mesh`, which has the vertices and
/// triangles of `shape`. Targets beyond the end of `morph_weights` have weight 0; `joints` are the joint_transforms
/// of its skin, empty without one. If the joints invert most of their vertices, like a mirroring, the winding of each
/// triangle is reversed, so that its front stays the same side. Returns whether the winding has changed.
bool shape_mesh(MeshShape& shape, std::span<const float> morph_weights, std::span<const Transform> joints, Mesh& mesh);

/// Computes the vertices at rest of the meshes of `shapes`, which belong to `scene`; its nodes and skins are valid.
void shape_at_rest(Scene& scene, std::span<MeshShape* const> shapes);

} // namespace pertev
