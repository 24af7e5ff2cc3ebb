#pragma once

// Materials in device code, and the shading variants for what all materials of a scene have in common.

#include <cstdint>
#include <span>

#include "base/host_device.h"
#include "scene/material.h"

namespace pertev {

/// Shading variants. A kernel compiled for the simplest variant that covers the scene uses fewer registers.
enum class ShadingVariant : uint8_t {
    General,
    Unstacked,    // no material is stacked (MaterialParameters::is_stacked)
    Diffuse,      // all materials are diffuse
    PlainDiffuse, // all are diffuse, opaque and without textures
};

inline ShadingVariant variant_of(std::span<const MaterialParameters> materials) {
    bool are_plain = true, are_diffuse = true;
    for (const MaterialParameters& m : materials) {
        if (m.is_stacked()) return ShadingVariant::General;
        are_diffuse = are_diffuse && m.kind == MaterialKind::Diffuse;
        are_plain = are_plain && m.alpha_mode == AlphaMode::Opaque && !m.base_color_texture.has_image() &&
                    !m.normal_texture.has_image() && !m.emission_texture.has_image();
    }
    if (!are_diffuse) return ShadingVariant::Unstacked;
    return are_plain ? ShadingVariant::PlainDiffuse : ShadingVariant::Diffuse;
}

/// Returns whether BSDFs may have other lobes than a diffuse one, so that sampling them needs a choice.
HD constexpr bool has_lobes(ShadingVariant variant) {
    return variant == ShadingVariant::General || variant == ShadingVariant::Unstacked;
}
HD constexpr bool has_textures(ShadingVariant variant) { return variant != ShadingVariant::PlainDiffuse; }

/// Features that emissive materials of a scene may have; each includes those before it.
enum class EmitterVariant : uint8_t { Plain, Textured, Coated };
HD constexpr EmitterVariant emitter_variant(ShadingVariant variant) {
    if (variant == ShadingVariant::General) return EmitterVariant::Coated;
    return has_textures(variant) ? EmitterVariant::Textured : EmitterVariant::Plain;
}

/// Returns whether a slot of a material has a texture; constant if the variant has none.
template <ShadingVariant kVariant>
HD inline bool has_texture(const TextureRef& slot) {
    return has_textures(kVariant) && slot.has_image();
}

} // namespace pertev
