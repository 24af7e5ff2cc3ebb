#pragma once

// The closed set of BSDFs as one small plain struct, so that a path keeps any of them in registers. Adding a kind:
// a file of its own, a case in each switch here (the compiler names the missing ones), a make function, and a line in
// tests/statistical/bsdf_cases.h.

#include <cstdint>

#include "base/host_device.h"
#include "shading/bsdf_sample.h"
#include "shading/conductor_bsdf.h"
#include "shading/dielectric_bsdf.h"
#include "shading/diffuse_bsdf.h"
#include "shading/metallic_roughness_bsdf.h"

namespace pertev {

enum class BsdfKind : uint8_t {
    Absorber, // scatters nothing: unlit surfaces, pure emitters
    Diffuse,
    Conductor,
    Dielectric,
    MetallicRoughness,
};

struct Bsdf {
    BsdfKind kind = BsdfKind::Absorber;
    float alpha = 0;    // all but Diffuse: GGX width
    float metallic = 0; // MetallicRoughness
    float ior = 1;      // Dielectric: index of refraction; MetallicRoughness: reflectance at normal incidence
    Rgb color = {};     // Diffuse: albedo; Conductor: eta; Dielectric: tint; MetallicRoughness: base colour
    Rgb k = {};         // Conductor

    HD DiffuseBsdf diffuse() const { return {color}; }
    HD ConductorBsdf conductor() const { return {color, k, alpha}; }
    HD DielectricBsdf dielectric() const { return {color, alpha, ior}; }
    HD MetallicRoughnessBsdf metallic_roughness() const { return {color, metallic, alpha, ior}; }

    HD BsdfValue evaluate(Vec3 wo, Vec3 wi) const {
        switch (kind) {
        case BsdfKind::Absorber:
            return {};
        case BsdfKind::Diffuse:
            return diffuse().evaluate(wo, wi);
        case BsdfKind::Conductor:
            return conductor().evaluate(wo, wi);
        case BsdfKind::Dielectric:
            return dielectric().evaluate(wo, wi);
        case BsdfKind::MetallicRoughness:
            return metallic_roughness().evaluate(wo, wi);
        }
        return {};
    }
    HD Rgb eval(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).f; }
    HD float pdf(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).pdf; }

    HD BsdfSample sample(Vec3 wo, float u_lobe, Vec2 u) const {
        switch (kind) {
        case BsdfKind::Absorber:
            return {};
        case BsdfKind::Diffuse:
            return diffuse().sample(wo, u_lobe, u);
        case BsdfKind::Conductor:
            return conductor().sample(wo, u_lobe, u);
        case BsdfKind::Dielectric:
            return dielectric().sample(wo, u_lobe, u);
        case BsdfKind::MetallicRoughness:
            return metallic_roughness().sample(wo, u_lobe, u);
        }
        return {};
    }

    /// sample() looks at u_lobe.
    HD bool draws_lobe() const {
        switch (kind) {
        case BsdfKind::Absorber:
        case BsdfKind::Diffuse:
            return false;
        case BsdfKind::Conductor:
        case BsdfKind::Dielectric:
        case BsdfKind::MetallicRoughness:
            break;
        }
        return true;
    }

    /// eval() is black for every pair of directions: light sampling is of no use here.
    HD bool has_delta_only() const {
        switch (kind) {
        case BsdfKind::Absorber:
            return true;
        case BsdfKind::Diffuse:
            return false;
        case BsdfKind::Conductor:
            return conductor().is_smooth();
        case BsdfKind::Dielectric:
            return dielectric().is_smooth();
        case BsdfKind::MetallicRoughness:
            return metallic_roughness().is_smooth() && !metallic_roughness().has_base();
        }
        return true;
    }
};

/// Perceptual roughness of a material, [0, 1], to GGX width.
HD inline float alpha_from_roughness(float roughness) { return square(clamp(roughness, 0.0f, 1.0f)); }

HD inline Bsdf make_absorber() { return {}; }
/// `albedo` in [0, 1].
HD inline Bsdf make_diffuse(Rgb albedo) { return {.kind = BsdfKind::Diffuse, .color = albedo}; }
/// Complex index eta + i k, both >= 0; roughness in [0, 1].
HD inline Bsdf make_conductor(Rgb eta, Rgb k, float roughness) {
    return {.kind = BsdfKind::Conductor, .alpha = alpha_from_roughness(roughness), .color = eta, .k = k};
}
/// `ior` > 0, inside over outside; a rough one's is moved into [1.1, 3] (or its inverse). `tint` in [0, 1].
HD inline Bsdf make_dielectric(float ior, float roughness, Rgb tint) {
    const float alpha = alpha_from_roughness(roughness);
    return {.kind = BsdfKind::Dielectric, .alpha = alpha, .ior = DielectricBsdf::usable_ior(ior, alpha), .color = tint};
}
/// `base_color`, `metallic` and `roughness` in [0, 1]; `ior` >= 1 of the coat.
HD inline Bsdf make_metallic_roughness(Rgb base_color, float metallic, float roughness, float ior) {
    return {.kind = BsdfKind::MetallicRoughness,
            .alpha = alpha_from_roughness(roughness),
            .metallic = clamp(metallic, 0.0f, 1.0f),
            .ior = f0_from_ior(ior),
            .color = base_color};
}

} // namespace pertev
