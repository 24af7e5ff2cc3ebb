#pragma once

// Makes the BSDF of metallic-roughness with everything that glTF's extensions add to its reflection and to what is
// beneath it. Coat and sheen come on top (bsdf.h).

#include "shading/bsdf.h"

namespace pertev {

/// Parameters of metallic-roughness with a weight and a colour of its reflection, a film, and light that goes through.
struct ReflectionParameters {
    Rgb base_color;                    // [0, 1]
    float metallic = 0, roughness = 1; // [0, 1]
    float ior = 1.5f;                  // > 0
    float weight = 1;                  // specularFactor, [0, 1]
    Rgb color = {1, 1, 1};             // specularColorFactor, >= 0
    float through = 0;                 // share of the diffuse light that goes straight through instead, [0, 1]
    float translucent = 0;             // share of the rest that leaves on the other side, [0, 1]
    Rgb translucent_color = {1, 1, 1}; // [0, 1]
    float solid = 0;                   // share of the diffuse light that enters a solid instead, [0, 1]
    float anisotropy = 0;              // [0, 1]
    Vec2 along = {1, 0};               // unit, the tangent along which the highlights are stretched
    ThinFilm film = {};
    float diffuse_roughness = 0; // [0, 1]
    float dispersion = 0;        // reciprocal of Abbe's number, >= 0
    Rgb metal_tint = {1, 1, 1};  // [0, 1], F82 tint of the metal
    float retroreflectivity = 0; // [0, 1], of the reflection; then it has no film
    bool is_beckmann = false, is_single = false;

    HD bool has_plain_microfacets() const { return !(anisotropy > 0) && !is_beckmann && !is_single; }
    HD bool is_clear() const { return is_plain() && !(dispersion > 0); }
    HD bool is_plain() const { return has_plain_microfacets() && !(film.weight > 0); }
    HD bool is_tinted() const { return metallic > 0 && !(metal_tint == Rgb{1, 1, 1}); }
    HD Microfacets microfacets() const { return microfacets_of(alpha_from_roughness(roughness)); }
    HD Microfacets rough_microfacets() const {
        return microfacets_of(max(alpha_from_roughness(roughness), kSmoothAlpha));
    }
    HD Microfacets microfacets_of(float alpha) const {
        Microfacets widths = anisotropic_widths(alpha, anisotropy, along);
        widths.is_beckmann = is_beckmann;
        widths.is_single = is_single;
        return widths;
    }
};

/// Makes a diffuse BSDF of `albedo` and `roughness` in [0, 1].
HD inline Bsdf make_rough_diffuse(Rgb albedo, float roughness) {
    return roughness > 0 ? Bsdf(RoughDiffuseLobe{albedo, 1, roughness}) : make_diffuse(albedo);
}

/// Makes a conductor of the complex index eta + i k with any microfacets; of the parameters it uses those and the
/// weight.
HD inline Bsdf make_metal(Rgb eta, Rgb k, const ReflectionParameters& p) {
    if (p.has_plain_microfacets() && !(p.weight < 1)) return make_conductor(eta, k, p.roughness);
    return Bsdf(MetalLobe{eta, k, p.microfacets(), p.weight});
}

/// Adds the reflection of a dielectric and a metal.
HD_CALL inline void add_reflection(Bsdf& bsdf, const ReflectionParameters& p, float metal) {
    if (!(p.weight > 0) && !(metal > 0)) return;
    const Rgb own = f0_from_ior(p.ior) * p.color;
    const Rgb f0 = p.weight * Rgb{min(own.r, 1.0f), min(own.g, 1.0f), min(own.b, 1.0f)};
    if (p.retroreflectivity > 0) {
        if (p.has_plain_microfacets() && !p.is_tinted()) {
            const float alpha = max(alpha_from_roughness(p.roughness), kSmoothAlpha);
            return bsdf.add(RetroLobe{{p.base_color, metal, alpha, f0, p.weight}, p.retroreflectivity});
        }
        const FilmedLobe all = {p.base_color, metal, p.rough_microfacets(), f0, p.weight, {}, p.metal_tint};
        return bsdf.add(FilmedRetroLobe{all, p.retroreflectivity});
    }
    if (p.is_plain() && !p.is_tinted()) {
        return bsdf.add(SpecularLobe{p.base_color, metal, alpha_from_roughness(p.roughness), f0, p.weight});
    }
    bsdf.add(FilmedLobe{p.base_color, metal, p.microfacets(), f0, p.weight, p.film, p.metal_tint});
}

/// Adds glass for `share` of the light; the index is clamped for a rough surface (make_dielectric).
HD_CALL inline void add_glass(Bsdf& bsdf, const ReflectionParameters& p, float share) {
    const float spread = 0.5f * p.dispersion * max(p.ior - 1.0f, 0.0f);
    bsdf.add(GlassLobe{p.base_color, share, p.microfacets(),
                       DielectricLobe::usable_ior(p.ior, alpha_from_roughness(p.roughness)), p.film, spread});
}

/// Makes `bsdf`, which is empty, that of the parameters, where it is: a result would be copied out of the call.
HD_CALL inline void build_reflection(Bsdf& bsdf, const ReflectionParameters& p) {
    const float metal_of_all = clamp(p.metallic, 0.0f, 1.0f), glass = (1.0f - metal_of_all) * p.solid;
    if (!(glass < 1)) {
        if (!p.is_clear()) return add_glass(bsdf, p, 1);
        bsdf = make_dielectric(p.ior, p.roughness, p.base_color);
        return;
    }
    const float metal = glass > 0 ? metal_of_all / (1.0f - glass) : metal_of_all;
    const float opaque = (1.0f - metal) * (1.0f - p.through), through = (1.0f - metal) * p.through;
    const float diffuse = opaque * (1.0f - p.translucent), far = opaque * p.translucent;
    if (diffuse > 0 && !is_black(p.base_color)) {
        bsdf = p.diffuse_roughness > 0 ? Bsdf(RoughDiffuseLobe{p.base_color, diffuse, p.diffuse_roughness})
                                       : Bsdf(DiffuseLobe{p.base_color, diffuse});
    }
    if (through > 0 && !is_black(p.base_color)) {
        bsdf.add(ThinLobe{p.base_color, through, p.microfacets()});
    }
    if (far > 0 && !is_black(p.translucent_color)) bsdf.add(TranslucentLobe{p.translucent_color, far});
    add_reflection(bsdf, p, metal);
    if (glass > 0) add_glass(bsdf, p, glass);
}
HD inline Bsdf make_reflection(const ReflectionParameters& p) {
    Bsdf bsdf;
    build_reflection(bsdf, p);
    return bsdf;
}

} // namespace pertev
