#pragma once

// What reshapes the mesh that a node shows, beside the place where it stands: its skin's joints and its morph weights.
//
// Source: glTF 2.0 sections 3.7.2.2 and 3.7.3.

#include "formats/gltf/buffers.h"
#include "scene/scene.h"

namespace pertev::gltf {

/// Fills scene.skins, and the skin and morph weights of scene.nodes, which are there. A skin with a joint
/// that is none is left out.
void read_node_shapes(const Document& document, Buffers& buffers, Scene& scene, Messages& messages);

} // namespace pertev::gltf
