#pragma once

// Metal with microfacets other than those of conductor_lobe.h, which has all others: stretched, Beckmann's, single
// scattering, or dimmed. It is a base.

#include "shading/lobes/fresnel.h"
#include "shading/lobes/layer_transmittance.h"
#include "shading/lobes/microfacets.h"

namespace pertev {

struct MetalLobe {
    Rgb eta, k; // complex index eta + i k, per channel, over that of the outside
    Microfacets widths;
    float weight = 1; // [0, 1], a factor on all that it reflects

    HD LobeClass lobe_class() const { return widths.is_smooth() ? LobeClass::Specular : LobeClass::Glossy; }
    HD float energy() const { return weight * max_component(fresnel_conductor_average(eta, k)); }
    HD Gloss gloss(float cos_o) const { return {weight * fresnel_conductor(cos_o, eta, k), widths.energy_width()}; }
    HD_CALL SpecularBranches specular(Vec3 wo) const {
        SpecularBranches branches;
        if (widths.is_smooth()) branches.mirror = weight * fresnel_conductor(abs(wo.z), eta, k);
        return branches;
    }

    HD_CALL BsdfValue evaluate(Vec3 wo, Vec3 wi, const LayerTransmittance& transmittance) const {
        if (widths.is_smooth() || !(wo.z * wi.z > 0)) return {};
        const Vec3 o = widths.turned({wo.x, wo.y, abs(wo.z)}), i = widths.turned({wi.x, wi.y, abs(wi.z)});
        const GgxReflection once = widths.evaluate_reflection(o, i);
        Rgb f = once.f * fresnel_conductor(once.cos_h, eta, k);
        float pdf = once.pdf;
        if (!widths.is_single) {
            const float lost_o = widths.lost(o), lost_i = widths.lost(i), lost = widths.average_lost();
            f += (i.z * kInvPi * lost_o * lost_i / lost) *
                 multiple_scattering_tint(fresnel_conductor_average(eta, k), lost);
            pdf = (1.0f - lost_o) * once.pdf + lost_o * widths.pdf_lost_lobe(i.z);
        }
        return {transmittance.light_on_metal() * (weight * f), transmittance.reach * pdf};
    }
    HD_CALL LobeDraw draw(Vec3 wo, float u_lobe, Vec2 u) const {
        if (widths.is_smooth()) return draw_mirror(wo, weight * fresnel_conductor(abs(wo.z), eta, k), 1);
        Vec3 wi;
        if (u_lobe < widths.lost(widths.turned({wo.x, wo.y, abs(wo.z)}))) {
            wi = widths.sample_lost_lobe(u);
        } else {
            wi = widths.sample_reflection(wo, u);
            if (!(wi.z > 0)) return {};
        }
        wi.z = copysign(wi.z, wo.z);
        return draw_direction(wi);
    }
};

} // namespace pertev
