#pragma once

// Skins: joints, and the joints and weights of vertices.
//
// Source: glTF 2.0 section 3.7.3. The node of a skinned mesh does not move it; only its joints do.

#include <vector>

#include "formats/gltf/accessor.h"
#include "scene/mesh_shape.h"

namespace pertev::gltf {

/// Inverse bind matrix of each joint (Skin::joint_from_mesh); empty if the file has none.
std::vector<Transform> read_inverse_bind_matrices(const Document& document, Buffers& buffers, const JsonValue& skin,
                                                  std::size_t joint_count);

/// Fills the joints and weights of `shape`, which has its positions, from the JOINTS_n and WEIGHTS_n of `attributes`.
/// An unreadable set, such as one with a joint beyond the skin's `joint_count`, is left out with all later ones.
void read_joint_weights(const Document& document, Buffers& buffers, const JsonValue& attributes,
                        std::size_t joint_count, MeshShape& shape, Sink& sink);

} // namespace pertev::gltf
