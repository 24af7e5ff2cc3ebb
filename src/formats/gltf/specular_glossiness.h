#pragma once

// Converts KHR_materials_pbrSpecularGlossiness, which many older files use, to metallic-roughness materials.
//
// Source: KHR_materials_pbrSpecularGlossiness; the conversion is that of its examples (convert-between-workflows). If
// all of the specular colour is grey and at most 0.16, no conversion is needed, because an index of refraction gives
// the same reflectance.

#include <cstdint>
#include <vector>

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev::gltf {

struct SpecularGlossiness {
    Rgb diffuse = {1, 1, 1}, specular = {1, 1, 1};
    float glossiness = 1;
};

/// The metallic-roughness values that a conversion from specular-glossiness gives.
struct MetallicRoughness {
    Rgb base_color = {1, 1, 1};
    float metallic = 0, roughness = 0;
    float ior = 1.5f;
};

/// Converts specular-glossiness values to metallic-roughness ones. `is_exact` is set to whether the conversion is exact
/// up to rounding.
MetallicRoughness metallic_roughness_of(const SpecularGlossiness& from, bool& is_exact);

/// A material whose textures must be converted texel by texel after decoding. Until then its base colour texture is
/// the diffuse one, and its roughness texture the specular-glossiness one.
struct PendingConversion {
    uint32_t material; // index into Scene::materials
    SpecularGlossiness factors;
    FileLocation location;
};

/// Gives each material of `pending` its own textures, two images that are appended to the scene's. `limit` is the
/// maximum number of bytes of all these; further materials get only their factors, with a warning.
void convert_textures(const std::vector<PendingConversion>& pending, uint64_t limit, Scene& scene, Sink& sink);

} // namespace pertev::gltf
