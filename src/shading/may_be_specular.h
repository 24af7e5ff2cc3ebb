#pragma once

// Whether a material may act as a smooth mirror, smooth glass or a pane.

#include "base/host_device.h"
#include "shading/bsdf.h"
#include "shading/shading_variant.h"

namespace pertev {

/// Returns whether a roughness, times a texture, may be that of a smooth surface.
HD inline bool may_be_smooth(float roughness, const TextureRef& texture) {
    return texture.has_image() || !(alpha_from_roughness(roughness) >= kSmoothAlpha);
}

/// Returns whether some point of a surface with this material may have a delta lobe.
HD inline bool may_be_specular(const MaterialParameters& material) {
    if (material.is_unlit()) return false;
    if (material.has_coat() && may_be_smooth(material.coat_roughness, material.coat_roughness_texture)) return true;
    switch (material.kind) {
    case MaterialKind::Diffuse:
    case MaterialKind::Unlit:
        return false;
    case MaterialKind::Dielectric:
        if (material.ior == 1) return true;
        break;
    case MaterialKind::MetallicRoughness:
        if (material.transmits() && material.ior == 1) return true;
        break;
    case MaterialKind::Conductor:
        break;
    }
    return may_be_smooth(material.roughness, material.roughness_texture);
}

/// Returns whether light may go straight through some point of a surface with this material, as through a pane.
HD inline bool may_pass_straight(const MaterialParameters& material) {
    return material.transmits() && material.thin_walled &&
           may_be_smooth(material.roughness, material.roughness_texture);
}

} // namespace pertev
