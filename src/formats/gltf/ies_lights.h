#pragma once

// Lights whose intensity is that of an IES photometric file (formats/ies/read_ies.h). They shine along the -z of their
// node, which is nadir; the horizontal angle 0 is its +x. Candelas are read as W/sr, one for one.
//
// Source: EXT_lights_ies.

#include "formats/files/file_access.h"
#include "formats/gltf/buffers.h"
#include "formats/gltf/node_graph.h"
#include "scene/scene.h"

namespace pertev::gltf {

/// Appends lights with IES profiles to scene.lights, in the order of the nodes. Anything unreadable is left out with a
/// warning.
void place_ies_lights(const Document& document, Buffers& buffers, const FileAccess& access, const NodeGraph& nodes,
                      Scene& scene, Sink& sink);

} // namespace pertev::gltf
