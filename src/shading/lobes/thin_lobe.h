#pragma once

// Light that goes straight through a thin wall, such as a pane: it enters and leaves at once, so nothing is refracted.
// It is a layer between a reflection and a diffuse base that has the rest of the light; it reflects nothing itself.
//
// Source: KHR_materials_transmission without a volume, whose rough lobe is the reflection's, mirrored to the other
// side; here its lost energy is compensated too (energy_tables.h). The reflection above takes the smaller of its two
// transmittances, which is reciprocal.

#include "shading/lobes/schlick_lobe.h"

namespace pertev {

struct ThinLobe {
    Rgb tint;    // [0, 1], of the light that goes through
    float share; // [0, 1], of the light that reaches it; the base has the rest
    float alpha; // GGX width = roughness^2, [0, 1]

    HD bool is_smooth() const { return !(alpha >= kSmoothAlpha); }
    HD LobeClass lobe_class() const { return is_smooth() ? LobeClass::Specular : LobeClass::Glossy; }
    HD float energy() const { return share * max_component(tint); }
    HD Gloss gloss(float) const { return {share * tint, alpha}; }
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
            const Vec3 o = {wo.x, wo.y, abs(wo.z)}, i = {wi.x, wi.y, abs(wi.z)};
            const GgxReflection once = evaluate_ggx_reflection(o, i, alpha);
            const float lost_o = metal_lost(o.z, alpha), lost_i = metal_lost(i.z, alpha);
            const float more = i.z * kInvPi * lost_o * lost_i / metal_average_lost(alpha);
            const float pdf = (1.0f - lost_o) * once.pdf + lost_o * pdf_grazing_lobe(i.z, alpha);
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
        if ((u_lobe - p_beneath) < (1.0f - p_beneath) * metal_lost(abs(wo.z), alpha)) {
            wi = sample_grazing_lobe(alpha, u);
        } else {
            const Vec3 o = {wo.x, wo.y, abs(wo.z)};
            wi = normalize(reflect(o, sample_ggx_visible_normal(o, alpha, u)));
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
