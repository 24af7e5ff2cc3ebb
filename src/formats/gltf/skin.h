#pragma once

// Skins: what the file says of joints and of the vertices that they move.
//
// Source: glTF 2.0 section 3.7.3. The node that holds a skinned mesh does not move it: only its joints do.

#include <vector>

#include "formats/gltf/accessor.h"
#include "scene/mesh_shape.h"

namespace pertev::gltf {

/// One a joint (Skin::joint_from_mesh); empty where the file has none.
std::vector<Transform> read_inverse_bind_matrices(const Document& document, Buffers& buffers, const JsonValue& skin,
                                                  std::size_t joint_count);

/// Fills the joints and weights of `shape`, which has its positions, by the JOINTS_n and WEIGHTS_n of `attributes`.
/// A set that cannot be read, as one of a joint that the skin, which has `joint_count`, does not have, is left out with
/// those after it.
void read_joint_weights(const Document& document, Buffers& buffers, const JsonValue& attributes,
                        std::size_t joint_count, MeshShape& shape, Messages& messages);

} // namespace pertev::gltf
