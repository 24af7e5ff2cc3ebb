#pragma once

// Deformations of the mesh of a node: the joints of its skin, and its morph weights.
//
// Source: glTF 2.0 sections 3.7.2.2 and 3.7.3.

#include "formats/gltf/buffers.h"
#include "scene/scene.h"

namespace pertev::gltf {

/// Fills scene.skins, and the skin and morph weights of scene.nodes, which have been read. A skin with an invalid
/// joint is left out.
void read_node_shapes(const Document& document, Buffers& buffers, Scene& scene, Sink& sink);

} // namespace pertev::gltf
