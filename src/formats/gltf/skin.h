#pragma once

// Skinned meshes in their rest pose: each vertex goes where its joints stand when no animation plays.
//
// Source: glTF 2.0 section 3.7.3.3. The node that holds a skinned mesh does not move it: only its joints do.

#include <vector>

#include "formats/gltf/accessor.h"
#include "formats/gltf/node_graph.h"
#include "scene/mesh.h"

namespace pertev::gltf {

/// World from mesh space, one a joint: the joint's node times its inverse bind matrix.
std::vector<Transform> read_joint_transforms(const Document& document, Buffers& buffers, const NodeGraph& nodes,
                                             const JsonValue& skin);

/// Moves the vertices of `mesh` to world space by the JOINTS_n and WEIGHTS_n of `attributes`. A vertex without weight
/// stays. Throws Error(BadInput) for a joint that the skin does not have.
void apply_skin(const Document& document, Buffers& buffers, const JsonValue& attributes,
                const std::vector<Transform>& joints, Mesh& mesh);

} // namespace pertev::gltf
