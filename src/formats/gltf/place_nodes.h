#pragma once

// What the scene's nodes put into the world: instances of meshes, lights, cameras.
//
// Source: glTF 2.0 sections 3.5 and 3.10; KHR_lights_punctual; EXT_mesh_gpu_instancing.

#include "formats/gltf/meshes.h"
#include "formats/gltf/node_graph.h"
#include "scene/scene.h"

namespace pertev::gltf {

/// Appends to scene.instances, scene.lights and scene.cameras, in the order of the nodes. What of them cannot
/// be read, or a node squashes to nothing, is left out with a warning.
void place_nodes(const Document& document, Buffers& buffers, const NodeGraph& nodes, Meshes& meshes, Scene& scene,
                 Messages& messages);

} // namespace pertev::gltf
