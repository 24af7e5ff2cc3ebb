#pragma once

// The geometry of one mesh primitive: attributes, indices, morph targets.
//
// Source: glTF 2.0 section 3.7.2; KHR_mesh_quantization.

#include <optional>
#include <vector>

#include "base/sink.h"
#include "formats/gltf/accessor.h"
#include "formats/gltf/document.h"
#include "formats/gltf/texture_sets.h"
#include "scene/mesh.h"
#include "scene/mesh_shape.h"

namespace pertev::gltf {

struct PrimitiveRequest {
    const Document& document;
    Buffers& buffers;
    const JsonValue& primitive;
    bool geometry_only = false; // only positions, normals and indices
    TextureSets sets = {0, 1};  // numbers of the sets that the mesh has
};

struct Primitive {
    Mesh mesh; // without the targets
    std::vector<MorphTarget> targets;
};

/// Reads a primitive. Returns nothing, with a warning, if it draws no triangle: points, lines, no positions, an
/// unsupported compression. Throws Error(BadInput) if positions or indices cannot be read; anything else that cannot
/// is left out with a warning. Normals and tangents are those of the file; validate() normalizes them.
std::optional<Primitive> read_primitive(const PrimitiveRequest& request, Sink& sink);

} // namespace pertev::gltf
