#pragma once

// Whether a material may act as a smooth mirror or smooth glass.

#include "base/host_device.h"
#include "shading/bsdf.h"
#include "shading/shading_variant.h"

namespace pertev {

/// Returns whether some point of a surface with this material may have a delta lobe.
HD inline bool may_be_specular(const MaterialParameters& material) {
    switch (material.kind) {
    case MaterialKind::Diffuse:
    case MaterialKind::Unlit:
        return false;
    case MaterialKind::Dielectric:
        if (material.ior == 1) return true;
        break;
    case MaterialKind::Conductor:
    case MaterialKind::MetallicRoughness:
        break;
    }
    return material.roughness_texture.has_image() || !(alpha_from_roughness(material.roughness) >= kSmoothAlpha);
}

} // namespace pertev
