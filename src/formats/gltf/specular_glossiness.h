#pragma once

// Converts KHR_materials_pbrSpecularGlossiness, which many older files use, to metallic-roughness materials without
// metal, whose dielectric reflects the specular colour (Material::specular_color). A grey specular colour of at most
// 0.16 becomes an index of refraction instead, which is less to compute. The diffuse colour is not darkened by the
// specular one (the extension's 1 - max(specular)), because light beneath a reflection is what it lets through:
// glTF 2.0 has dropped that factor from metallic-roughness for the same reason.
//
// Source: KHR_materials_pbrSpecularGlossiness, appendix.

#include <cstdint>
#include <vector>

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev::gltf {

struct SpecularGlossiness {
    Rgb diffuse = {1, 1, 1}, specular = {1, 1, 1};
    float glossiness = 1;
};

/// Sets the numbers of a material; `has_texture` says whether the specular colour has one too.
void set_specular_glossiness(const SpecularGlossiness& from, bool has_texture, Material& material);

/// A material with a texture of glossiness, the opposite of roughness. Until convert_gloss its roughness texture is the
/// specular-glossiness one.
struct PendingGloss {
    uint32_t material; // index into Scene::materials
    float glossiness;
    FileLocation location;
};

/// Gives each material of `pending` a texture of its roughness, which is appended to the scene's images after they have
/// been decoded. `limit` is the maximum number of bytes of all these; further materials get only their factor, with a
/// warning.
void convert_gloss(const std::vector<PendingGloss>& pending, uint64_t limit, Scene& scene, Sink& sink);

} // namespace pertev::gltf
