#pragma once

// Geometry compressed by Draco, decoded by libdraco if the build has it (docs/dependencies.md).
//
// Source: KHR_draco_mesh_compression.

#include "formats/gltf/buffers.h"
#include "formats/gltf/document.h"

namespace pertev::gltf {

/// Returns whether this build decodes Draco.
bool has_draco();

/// Decodes the stream of a primitive and gives its attributes and indices to `buffers`, as the data of those accessors
/// of the primitive that have none. Throws Error(BadInput) if the stream is damaged or does not fit the accessors.
void decode_draco(const Document& document, Buffers& buffers, const JsonValue& primitive);

} // namespace pertev::gltf
