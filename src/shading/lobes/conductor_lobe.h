#pragma once

// Metal: exact Fresnel reflectance of a complex index, GGX microfacets, perfectly smooth below kSmoothAlpha. A
// reciprocal second lobe compensates the loss of single scattering (energy_tables.h). Both sides reflect equally.
// draw() samples a visible normal with the probability of the share that single scattering returns, else that lobe.

#include "base/host_device.h"
#include "shading/lobes/energy_tables.h"
#include "shading/lobes/fresnel.h"
#include "shading/lobes/ggx.h"
#include "shading/lobes/grazing_lobe.h"
#include "shading/lobes/layer_transmittance.h"

namespace pertev {

struct ConductorLobe {
    Rgb eta, k;  // complex index eta + i k, per channel, over that of the outside
    float alpha; // GGX width = roughness^2, [0, 1]

    HD bool is_smooth() const { return !(alpha >= kSmoothAlpha); }

    HD LobeClass lobe_class() const { return is_smooth() ? LobeClass::Specular : LobeClass::Glossy; }
    HD float energy() const { return max_component(fresnel_conductor_average(eta, k)); }
    HD Gloss gloss(float cos_o) const { return {fresnel_conductor(cos_o, eta, k), alpha}; }
    HD SpecularBranches specular(Vec3 wo) const {
        SpecularBranches branches;
        if (is_smooth()) branches.mirror = fresnel_conductor(abs(wo.z), eta, k);
        return branches;
    }

    HD BsdfValue evaluate(Vec3 wo, Vec3 wi, const LayerTransmittance& transmittance) const {
        if (is_smooth() || !(wo.z * wi.z > 0)) return {};
        const Vec3 o = {wo.x, wo.y, abs(wo.z)}, i = {wi.x, wi.y, abs(wi.z)};
        const GgxReflection once = evaluate_ggx_reflection(o, i, alpha);
        const float lost_o = metal_lost(o.z, alpha), lost_i = metal_lost(i.z, alpha);
        const float lost = metal_average_lost(alpha), cosine = i.z * kInvPi;
        const Rgb more = multiple_scattering_tint(fresnel_conductor_average(eta, k), lost);
        return {transmittance.light_on_metal() *
                    (once.f * fresnel_conductor(once.cos_h, eta, k) + (cosine * lost_o * lost_i / lost) * more),
                transmittance.reach * ((1.0f - lost_o) * once.pdf + lost_o * pdf_metal_lost(i.z, alpha))};
    }
    HD LobeDraw draw(Vec3 wo, float u_lobe, Vec2 u) const {
        if (is_smooth()) return draw_mirror(wo, fresnel_conductor(abs(wo.z), eta, k), 1);
        Vec3 wi;
        if (u_lobe < metal_lost(abs(wo.z), alpha)) {
            wi = sample_metal_lost(alpha, u);
        } else {
            const Vec3 o = {wo.x, wo.y, abs(wo.z)};
            wi = normalize(reflect(o, sample_ggx_visible_normal(o, alpha, u)));
            if (!(wi.z > 0)) return {}; // into the surface: lost, and part of the energy that the second lobe returns
        }
        wi.z = copysign(wi.z, wo.z);
        return draw_direction(wi);
    }
};

} // namespace pertev
