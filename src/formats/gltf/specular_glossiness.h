#pragma once

// KHR_materials_pbrSpecularGlossiness, which many older files have for their materials, as metallic-roughness
// materials.
//
// Source: KHR_materials_pbrSpecularGlossiness; the conversion is that of its examples (convert-between-workflows).
// Where all of the specular colour is grey and at most 0.16, no conversion is needed: an index of refraction gives the
// same reflectance.

#include <cstdint>
#include <vector>

#include "base/messages.h"
#include "scene/scene.h"

namespace pertev::gltf {

struct SpecularGlossiness {
    Rgb diffuse = {1, 1, 1}, specular = {1, 1, 1};
    float glossiness = 1;
};

/// Metallic-roughness numbers for specular-glossiness ones.
struct MetallicRoughness {
    Rgb base_color = {1, 1, 1};
    float metallic = 0, roughness = 0;
    float ior = 1.5f;
};

/// `is_exact`: whether nothing is lost but what rounding takes.
MetallicRoughness metallic_roughness_of(const SpecularGlossiness& from, bool& is_exact);

/// A material whose textures must be converted texel by texel once they are decoded. Until then its base colour texture
/// is the diffuse one, and its roughness texture the specular-glossiness one.
struct PendingConversion {
    uint32_t material; // index into Scene::materials
    SpecularGlossiness factors;
    Place place;
};

/// Gives each material of `pending` textures of its own, two images that are appended to the scene's. `limit`: bytes
/// that all of these may take; materials beyond are left with their factors alone, with a warning.
void convert_textures(const std::vector<PendingConversion>& pending, uint64_t limit, Scene& scene, Messages& messages);

} // namespace pertev::gltf
