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
/// may have any length until finish_normals has seen them.
std::optional<Mesh> read_primitive(const PrimitiveRequest& request, Messages& messages);

/// Brings normals and tangents to unit length. A normal without direction becomes the mean of the faces around; if any
/// tangent has none, all are dropped, and the renderer derives them from the texture coordinates.
void finish_normals(Mesh& mesh);

} // namespace pertev::gltf
