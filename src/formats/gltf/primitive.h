#pragma once

// The geometry of one mesh primitive: attributes, indices, morph targets.
//
// Source: glTF 2.0 section 3.7.2; KHR_mesh_quantization.

#include <optional>
#include <vector>

#include "base/messages.h"
#include "formats/gltf/accessor.h"
#include "formats/gltf/document.h"
#include "scene/mesh.h"
#include "scene/mesh_shape.h"

namespace pertev::gltf {

struct PrimitiveRequest {
    const Document& document;
    Buffers& buffers;
    const JsonValue& primitive;
    bool geometry_only = false; // positions, normals and indices alone
};

struct Primitive {
    Mesh mesh; // without the targets
    std::vector<MorphTarget> targets;
};

/// Nothing, after a warning, where the primitive draws no triangle: points, lines, no positions, a compression that is
/// not supported. Throws Error(BadInput) where positions or indices cannot be read; of what else cannot be, a warning
/// says that it is left out. Normals and tangents
/// are as the file gives them; validate() brings them to unit length.
std::optional<Primitive> read_primitive(const PrimitiveRequest& request, Messages& messages);

} // namespace pertev::gltf
