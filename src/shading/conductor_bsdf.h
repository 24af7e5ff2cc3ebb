#pragma once

// Metal: exact Fresnel reflectance of a complex index, GGX microfacets, perfectly smooth below kSmoothAlpha. What
// single scattering loses comes back through a reciprocal second lobe (energy_tables.h). Both sides reflect alike.
// sample() takes a visible normal with the probability of the share that one bounce returns, else the
// grazing lobe.

#include "base/host_device.h"
#include "shading/bsdf_sample.h"
#include "shading/energy_tables.h"
#include "shading/fresnel.h"
#include "shading/ggx.h"
#include "shading/grazing_lobe.h"

namespace pertev {

/// Mirror image of `wo` about the unit normal `m`.
HD inline Vec3 reflect(Vec3 wo, Vec3 m) { return 2.0f * dot(wo, m) * m - wo; }

/// The single-scattering lobe of reflection, without Fresnel's factor: what all GGX reflectors share.
struct GgxReflection {
    float f = 0;     // D G2 / (4 |cos(wo)|), 1/sr
    float pdf = 0;   // of reflecting wo about a visible normal
    float cos_h = 0; // wo . h
};
/// wo.z > 0, wi.z > 0.
HD inline GgxReflection evaluate_ggx_reflection(Vec3 wo, Vec3 wi, float alpha) {
    const Vec3 sum = wo + wi;
    const Vec3 h = (1.0f / sqrt(length_squared(sum))) * sum;
    const float d = ggx_normals(h, alpha);
    const float so = ggx_slope_length(wo.z, alpha), si = ggx_slope_length(wi.z, alpha);
    return {d * wi.z / (2.0f * (so * wi.z + si * wo.z)), d / (2.0f * (wo.z + so)), min(abs(dot(wo, h)), 1.0f)};
}

struct ConductorBsdf {
    Rgb eta, k;  // complex index eta + i k, per channel, over that of the outside
    float alpha; // GGX width = roughness^2, [0, 1]

    HD bool is_smooth() const { return !(alpha >= kSmoothAlpha); }

    HD BsdfValue evaluate(Vec3 wo, Vec3 wi) const {
        if (is_smooth() || !(wo.z * wi.z > 0)) return {};
        const Vec3 o = {wo.x, wo.y, abs(wo.z)}, i = {wi.x, wi.y, abs(wi.z)};
        const GgxReflection once = evaluate_ggx_reflection(o, i, alpha);
        const float lost_o = metal_lost(o.z, alpha), lost_i = metal_lost(i.z, alpha);
        const float lost = metal_average_lost(alpha), cosine = i.z * kInvPi;
        const Rgb more = multiple_scattering_tint(fresnel_conductor_average(eta, k), lost);
        return {once.f * fresnel_conductor(once.cos_h, eta, k) + (cosine * lost_o * lost_i / lost) * more,
                (1.0f - lost_o) * once.pdf + lost_o * pdf_grazing_lobe(i.z, alpha)};
    }
    HD Rgb eval(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).f; }
    HD float pdf(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).pdf; }

    HD BsdfSample sample(Vec3 wo, float u_lobe, Vec2 u) const {
        if (wo.z == 0) return {};
        if (is_smooth())
            return {
                .wi = {-wo.x, -wo.y, wo.z}, .weight = fresnel_conductor(abs(wo.z), eta, k), .pdf = 1, .is_delta = true};
        Vec3 wi;
        if (u_lobe < metal_lost(abs(wo.z), alpha)) {
            wi = sample_grazing_lobe(alpha, u);
        } else {
            const Vec3 o = {wo.x, wo.y, abs(wo.z)};
            wi = normalize(reflect(o, sample_ggx_visible_normal(o, alpha, u)));
            if (!(wi.z > 0)) return {}; // into the surface: lost, and part of what the second lobe returns
        }
        wi.z = copysign(wi.z, wo.z);
        return make_bsdf_sample(wi, evaluate(wo, wi));
    }
};

} // namespace pertev
