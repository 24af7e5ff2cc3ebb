#pragma once

// The geometry of one mesh primitive: attributes, indices, and morph targets at given weights.
//
// Source: glTF 2.0 section 3.7.2; KHR_mesh_quantization.

#include <optional>
#include <span>

#include "base/messages.h"
#include "formats/gltf/accessor.h"
#include "formats/gltf/document.h"
#include "scene/mesh.h"

namespace pertev::gltf {

struct PrimitiveRequest {
    const Document& document;
    Buffers& buffers;
    const JsonValue& primitive;
    std::span<const float> morph_weights; // by target; a target past the end has weight 0
    bool geometry_only = false;           // positions, normals and indices alone
};

/// Nothing, after a warning, where the primitive draws no triangle: points, lines, no positions. Normals and tangents
/// are as the file and the morph targets give them; validate() brings them to unit length.
std::optional<Mesh> read_primitive(const PrimitiveRequest& request, Messages& messages);

} // namespace pertev::gltf
