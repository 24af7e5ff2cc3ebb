#pragma once

// Light that goes straight through a thin wall, such as a pane: it enters and leaves at once, so nothing is refracted.
// It is a layer between a reflection and a diffuse base that has the rest of the light; it reflects nothing itself.
//
// Source: KHR_materials_transmission without a volume, whose rough lobe is the reflection's, mirrored to the other
// side; here its lost energy is compensated too (Microfacets::lost). The reflection above takes the smaller of its two
// transmittances, which is reciprocal.

#include "shading/lobes/layer_transmittance.h"
#include "shading/lobes/microfacets.h"

namespace pertev {

struct ThinLobe {
    Rgb tint;    // [0, 1], of the light that goes through
    float share; // [0, 1], of the light that reaches it; the base has the rest
    Microfacets widths;

    HD bool is_smooth() const { return widths.is_smooth(); }
    HD LobeClass lobe_class() const { return is_smooth() ? LobeClass::Specular : LobeClass::Glossy; }
    HD float energy() const { return share * max_component(tint); }
    HD Gloss gloss(float) const { return {share * tint, widths.energy_width()}; }
    HD_CALL SpecularBranches specular(Vec3 wo) const {
        SpecularBranches branches;
        if (!is_smooth()) return branches;
        branches.refraction = share * tint;
        branches.refracted = -wo;
        return branches;
    }

    HD_CALL BsdfValue evaluate(Vec3 wo, Vec3 wi, float beneath, LayerTransmittance& transmittance) const {
        const float p_beneath = probability_beneath(beneath);
        BsdfValue value;
        if (!is_smooth() && wo.z * wi.z < 0) {
            const Vec3 o = widths.turned({wo.x, wo.y, abs(wo.z)}), i = widths.turned({wi.x, wi.y, abs(wi.z)});
            const GgxReflection once = widths.evaluate_reflection(o, i);
            const float lost_o = widths.lost(o), lost_i = widths.lost(i);
            const float more = i.z * kInvPi * lost_o * lost_i / max(widths.average_lost(), 1e-9f);
            const float pdf = (1.0f - lost_o) * once.pdf + lost_o * widths.pdf_lost_lobe(i.z);
            value = {(transmittance.light_of_delta() * share * (once.f + more)) * tint,
                     transmittance.reach * ((1.0f - p_beneath) * pdf)};
        }
        transmittance.reach = transmittance.reach * p_beneath;
        return value;
    }
    HD_CALL LobeDraw draw(Vec3 wo, float beneath, float u_lobe, Vec2 u) const {
        const float p_beneath = probability_beneath(beneath);
        if (u_lobe < p_beneath) return draw_beneath(u_lobe, p_beneath);
        if (is_smooth()) {
            return {.sample = {.wi = -wo,
                               .weight = (share / (1.0f - p_beneath)) * tint,
                               .pdf = 1.0f - p_beneath,
                               .is_transmission = true}};
        }
        Vec3 wi;
        if ((u_lobe - p_beneath) < (1.0f - p_beneath) * widths.lost(widths.turned({wo.x, wo.y, abs(wo.z)}))) {
            wi = widths.sample_lost_lobe(u);
        } else {
            wi = widths.sample_reflection(wo, u);
            if (!(wi.z > 0)) return {};
        }
        wi.z = copysign(wi.z, -wo.z);
        return draw_direction(wi, true);
    }

private:
    /// Probability of sampling what lies beneath. `energy` is that of what reaches each.
    HD float probability_beneath(float beneath) const { return beneath > 0 ? beneath / (beneath + energy()) : 0.0f; }
};

} // namespace pertev
