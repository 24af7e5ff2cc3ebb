#pragma once

// Diffuse light that goes through a thin sheet, such as a leaf or paper: Lambert's law on the other side of wo
// (KHR_materials_diffuse_transmission). It is a layer between a reflection and a diffuse base that has the rest of the
// light, as thin_lobe.h.

#include "math/sampling.h"
#include "shading/lobes/layer_transmittance.h"

namespace pertev {

struct TranslucentLobe {
    Rgb color;   // [0, 1], of the light that goes through
    float share; // [0, 1], of the light that reaches it; the base has the rest

    HD LobeClass lobe_class() const { return LobeClass::Diffuse; }
    HD float energy() const { return share * max_component(color); }

    HD_CALL BsdfValue evaluate(Vec3 wo, Vec3 wi, float beneath, LayerTransmittance& transmittance) const {
        const float p_beneath = probability_beneath(beneath);
        BsdfValue value;
        if (wo.z * wi.z < 0) {
            const float pdf = abs(wi.z) * kInvPi;
            value = {(transmittance.light_of_delta() * share * pdf) * color,
                     transmittance.reach * ((1.0f - p_beneath) * pdf)};
        }
        transmittance.reach = transmittance.reach * p_beneath;
        return value;
    }
    HD_CALL LobeDraw draw(Vec3 wo, float beneath, float u_lobe, Vec2 u) const {
        const float p_beneath = probability_beneath(beneath);
        if (u_lobe < p_beneath) return draw_beneath(u_lobe, p_beneath);
        Vec3 wi = sample_cosine_hemisphere(u);
        wi.z = copysign(wi.z, -wo.z);
        return draw_direction(wi, true);
    }

private:
    HD float probability_beneath(float beneath) const { return beneath > 0 ? beneath / (beneath + energy()) : 0.0f; }
};

} // namespace pertev
