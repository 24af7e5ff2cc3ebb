#pragma once

// Glass, water: reflection and refraction at GGX microfacets, a perfectly smooth interface below kSmoothAlpha.
//
// Source: Walter et al. 2007 (section 5; refraction's Jacobian is equation 17), in the units of bsdf_sample.h:
// radiance over n^2, so f(wo, wi) / n_i^2 = f(wi, wo) / n_o^2. Lobes after Kulla & Conty 2017 compensate the lost
// energy, on the near side with share 1 - T and on the far side with share T; reciprocity requires that T of the two
// sides have the ratio of n^2 times their average loss, which transmitted_share() ensures. wo.z > 0 is the outside,
// where the index is 1; the inside has index `ior`.

#include "base/host_device.h"
#include "shading/lobes/energy_tables.h"
#include "shading/lobes/fresnel.h"
#include "shading/lobes/ggx.h"
#include "shading/lobes/grazing_lobe.h"
#include "shading/lobes/layer_transmittance.h"

namespace pertev {

struct DielectricLobe {
    Rgb tint;    // factor on transmitted light, [0, 1]
    float alpha; // GGX width = roughness^2, [0, 1]
    float ior;   // inside over outside; if rough, within [1.1, 3] or its inverse (usable_ior)

    /// Clamps a rough surface's index to the range of the energy tables. An index of 1, which means no interface, does
    /// not change.
    HD static float usable_ior(float ior, float alpha) {
        using energy_table::kIorMax, energy_table::kIorMin;
        if (!(alpha >= kSmoothAlpha) || ior == 1) return ior;
        return ior > 1 ? clamp(ior, kIorMin, kIorMax) : clamp(ior, 1.0f / kIorMax, 1.0f / kIorMin);
    }

    /// Fraction of the light lost on the near side that is returned on the far side.
    HD static float transmitted_share(float eta, float average_near, float average_far) {
        return (1.0f - fresnel_dielectric_average(eta)) * min(1.0f, average_far / average_near);
    }

    HD bool is_smooth() const { return !(alpha >= kSmoothAlpha) || ior == 1; }
    /// Index of the far side over that of the near side.
    HD float eta_from(Vec3 wo) const { return wo.z > 0 ? ior : 1.0f / ior; }

    HD LobeClass lobe_class() const { return is_smooth() ? LobeClass::Specular : LobeClass::Glossy; }
    HD float energy() const { return 1; }
    HD Gloss gloss(float) const { return {grey(1), alpha}; }
    HD SpecularBranches specular(Vec3 wo) const {
        if (!is_smooth()) return {};
        const float eta = eta_from(wo);
        const DielectricFresnel fresnel = fresnel_dielectric(min(abs(wo.z), 1.0f), eta);
        const float r = fresnel.reflectance;
        SpecularBranches branches = {.mirror = grey(r)};
        if (!(r < 1)) return branches;
        branches.refraction = (1.0f - r) * tint;
        branches.refracted = refracted(wo, eta, fresnel);
        return branches;
    }

    HD BsdfValue evaluate(Vec3 wo, Vec3 wi, const LayerTransmittance& transmittance) const {
        if (is_smooth() || !(abs(wo.z) > 0 && abs(wi.z) > 0)) return {};
        const float eta = eta_from(wo);
        const Vec3 o = {wo.x, wo.y, abs(wo.z)};
        const bool transmitted = wo.z * wi.z < 0;
        const float cos_i = abs(wi.z);
        const float lost_o = glass_lost(o.z, alpha, eta), average_o = glass_average_lost(alpha, eta);
        const float average_far = glass_average_lost(alpha, 1.0f / eta);
        const float share = transmitted_share(eta, average_o, average_far);
        const float cosine = cos_i * kInvPi, grazing = pdf_grazing_lobe(cos_i, alpha);
        if (!transmitted) {
            const GgxReflection once = evaluate_ggx_reflection(o, {wi.x, wi.y, cos_i}, alpha);
            const float reflectance = fresnel_dielectric(once.cos_h, eta).reflectance;
            const float more = (1.0f - share) * lost_o * glass_lost(cos_i, alpha, eta) / average_o;
            return {grey(transmittance.light * (once.f * reflectance + cosine * more)),
                    transmittance.reach *
                        ((1.0f - lost_o) * reflectance * once.pdf + lost_o * (1.0f - share) * grazing)};
        }
        float f = share * lost_o * glass_lost(cos_i, alpha, 1.0f / eta) / average_far * cosine;
        float pdf = lost_o * share * grazing;
        // All of refraction is computed from the outside's direction a and the inside's b, whichever of them is wo.
        // The two ways then round equally, and near the critical angle, where a . h cancels, the lobe stays
        // reciprocal.
        const bool outside = wo.z > 0;
        const Vec3 a = outside ? wo : wi, b = outside ? wi : wo;
        const Vec3 sum = a + ior * b; // the half vector; its length is |a . h + ior b . h|
        const float length2 = length_squared(sum);
        const Vec3 h = ((ior > 1 ? -1.0f : 1.0f) / sqrt(length2)) * sum; // towards a
        const float ah = min(dot(a, h), 1.0f), bh = min(-dot(b, h), 1.0f);
        if (ah > 0 && bh > 0 && h.z > 0) {
            const float so = ggx_slope_length(o.z, alpha), si = ggx_slope_length(cos_i, alpha);
            const float jacobian = (outside ? ior * ior : 1.0f) / length2;
            const float d = 2.0f * transmittance_dielectric(ah, bh, ior) * ggx_normals(h, alpha) * ah * bh * jacobian;
            f += d * cos_i / (so * cos_i + si * o.z);
            pdf += (1.0f - lost_o) * d / (o.z + so);
        }
        return {(transmittance.light * f) * tint, transmittance.reach * pdf};
    }
    HD LobeDraw draw(Vec3 wo, float u_lobe, Vec2 u) const {
        const float eta = eta_from(wo);
        const Vec3 o = {wo.x, wo.y, abs(wo.z)}; // mirrored to the upper side, together with i
        if (is_smooth()) return draw_smooth(wo, u_lobe, eta);

        Vec3 i;
        const float lost = glass_lost(o.z, alpha, eta);
        if (u_lobe < lost) {
            const float share =
                transmitted_share(eta, glass_average_lost(alpha, eta), glass_average_lost(alpha, 1.0f / eta));
            i = sample_grazing_lobe(alpha, u);
            if (u_lobe < lost * share) i.z = -i.z;
        } else {
            const Vec3 m = sample_ggx_visible_normal(o, alpha, u);
            const float cos_m = clamp(dot(o, m), 0.0f, 1.0f);
            const DielectricFresnel fresnel = fresnel_dielectric(cos_m, eta);
            if (u_lobe - lost < (1.0f - lost) * fresnel.reflectance) {
                i = normalize(reflect(o, m));
                if (!(i.z > 0)) return {};
            } else {
                i = normalize((cos_m / eta - fresnel.cos_t) * m - (1.0f / eta) * o);
                if (!(i.z < 0)) return {};
            }
        }
        return draw_direction({i.x, i.y, wo.z < 0 ? -i.z : i.z}, i.z < 0);
    }

private:
    HD LobeDraw draw_smooth(Vec3 wo, float u_lobe, float eta) const {
        const DielectricFresnel fresnel = fresnel_dielectric(min(abs(wo.z), 1.0f), eta);
        const float r = fresnel.reflectance;
        if (u_lobe < r) return draw_mirror(wo, grey(1), r);
        if (!(r < 1)) return {};
        return {
            .sample = {.wi = refracted(wo, eta, fresnel), .weight = tint, .pdf = 1.0f - r, .is_transmission = true}};
    }
    HD static Vec3 refracted(Vec3 wo, float eta, const DielectricFresnel& fresnel) {
        return normalize(Vec3{-wo.x / eta, -wo.y / eta, -copysign(fresnel.cos_t, wo.z)});
    }
};

} // namespace pertev
