#pragma once

// Makes the BSDF of metallic-roughness with everything that glTF's extensions add to its reflection and to what is
// beneath it. Coat and sheen come on top (bsdf.h).

#include "shading/bsdf.h"

namespace pertev {

/// Parameters of metallic-roughness with a weight and a colour of its reflection, a film, and light that goes through.
struct ReflectionParameters {
    Rgb base_color;                    // [0, 1]
    float metallic = 0, roughness = 1; // [0, 1]
    float ior = 1.5f;                  // >= 1
    float weight = 1;                  // specularFactor, [0, 1]
    Rgb color = {1, 1, 1};             // specularColorFactor, >= 0
    float through = 0;                 // share of the diffuse light that goes straight through instead, [0, 1]
    float translucent = 0;             // share of the rest that leaves on the other side, [0, 1]
    Rgb translucent_color = {1, 1, 1}; // [0, 1]
    float solid = 0;                   // share of the diffuse light that enters a solid instead, [0, 1]
    float anisotropy = 0;              // [0, 1]
    Vec2 along = {1, 0};               // unit, the tangent along which the highlights are stretched
    ThinFilm film = {};

    HD bool is_plain() const { return !(anisotropy > 0) && !(film.weight > 0); }
};

/// Adds the reflection of a dielectric and a metal.
HD inline void add_reflection(Bsdf& bsdf, const ReflectionParameters& p, float metal) {
    if (!(p.weight > 0) && !(metal > 0)) return;
    const float alpha = alpha_from_roughness(p.roughness);
    const Rgb own = f0_from_ior(p.ior) * p.color;
    const Rgb f0 = p.weight * Rgb{min(own.r, 1.0f), min(own.g, 1.0f), min(own.b, 1.0f)};
    if (p.is_plain()) return bsdf.add(SpecularLobe{p.base_color, metal, alpha, f0, p.weight});
    bsdf.add(FilmedLobe{p.base_color, metal, anisotropic_widths(alpha, p.anisotropy, p.along), f0, p.weight, p.film});
}

/// Adds glass for `share` of the light; the index is clamped for a rough surface (make_dielectric).
HD inline void add_glass(Bsdf& bsdf, const ReflectionParameters& p, float share) {
    const float alpha = alpha_from_roughness(p.roughness);
    bsdf.add(GlassLobe{p.base_color, share, anisotropic_widths(alpha, p.anisotropy, p.along),
                       DielectricLobe::usable_ior(p.ior, alpha), p.film});
}

HD inline Bsdf make_reflection(const ReflectionParameters& p) {
    const float metal_of_all = clamp(p.metallic, 0.0f, 1.0f), glass = (1.0f - metal_of_all) * p.solid;
    Bsdf bsdf;
    if (!(glass < 1)) {
        if (p.is_plain()) return make_dielectric(p.ior, p.roughness, p.base_color);
        add_glass(bsdf, p, 1);
        return bsdf;
    }
    const float metal = glass > 0 ? metal_of_all / (1.0f - glass) : metal_of_all;
    const float opaque = (1.0f - metal) * (1.0f - p.through), through = (1.0f - metal) * p.through;
    const float diffuse = opaque * (1.0f - p.translucent), far = opaque * p.translucent;
    if (diffuse > 0 && !is_black(p.base_color)) bsdf.base = DiffuseLobe{p.base_color, diffuse};
    if (through > 0 && !is_black(p.base_color)) {
        bsdf.add(ThinLobe{p.base_color, through, alpha_from_roughness(p.roughness)});
    }
    if (far > 0 && !is_black(p.translucent_color)) bsdf.add(TranslucentLobe{p.translucent_color, far});
    add_reflection(bsdf, p, metal);
    if (glass > 0) add_glass(bsdf, p, glass);
    return bsdf;
}

} // namespace pertev
