#pragma once

// A material as device code sees it: scene/material.h without its name.

#include "scene/material.h"

namespace pertev {

struct MaterialView {
    MaterialKind kind;
    AlphaMode alpha_mode;
    bool two_sided_emission;
    float alpha, alpha_cutoff;
    Rgb base_color, emission, eta, k;
    float metallic, roughness, ior, normal_scale;
    TextureRef base_color_texture, alpha_texture, metallic_texture, roughness_texture, emission_texture, normal_texture;
};

inline MaterialView make_material_view(const Material& m) {
    return {.kind = m.kind,
            .alpha_mode = m.alpha_mode,
            .two_sided_emission = m.two_sided_emission,
            .alpha = m.alpha,
            .alpha_cutoff = m.alpha_cutoff,
            .base_color = m.base_color,
            .emission = m.emission,
            .eta = m.eta,
            .k = m.k,
            .metallic = m.metallic,
            .roughness = m.roughness,
            .ior = m.ior,
            .normal_scale = m.normal_scale,
            .base_color_texture = m.base_color_texture,
            .alpha_texture = m.alpha_texture,
            .metallic_texture = m.metallic_texture,
            .roughness_texture = m.roughness_texture,
            .emission_texture = m.emission_texture,
            .normal_texture = m.normal_texture};
}

} // namespace pertev
