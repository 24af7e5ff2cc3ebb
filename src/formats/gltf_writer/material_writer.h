#pragma once

// Writes materials: metallic-roughness and the KHR_materials extensions that read_gltf reads. What glTF has no place
// for is lost, and named.

#include <string>

#include "formats/gltf_writer/glb_parts.h"
#include "formats/gltf_writer/texture_writer.h"
#include "scene/scene.h"

namespace pertev::glb {

/// Returns a material's object. `owner` names it in messages.
std::string material_object(const Material& material, const std::string& owner, TextureWriter& textures,
                            GlbParts& parts, Sink& sink);

/// Returns a power of two that is at least the greatest channel and at least 1, by which a colour is divided exactly to
/// be in [0, 1].
float strength_of(Rgb color);

} // namespace pertev::glb
