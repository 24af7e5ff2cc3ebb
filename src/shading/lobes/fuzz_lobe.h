#pragma once

// Fuzz of OpenPBR: light that a layer of upright fibres scatters many times, most of it back and at grazing angles. It
// is a layer that may lie on anything.
//
// Source: Zeltner, Burley, Chiang, "Practical Multiple-Scattering Sheen Using Linearly Transformed Cosines", 2022.
// Their fit for one view is not reciprocal. Here the value is the harmonic mean of the fits for both directions, whose
// magnitudes make the albedo that of the fibres (tools/make_fuzz_table.py). The fit for wo is sampled, so a weight is
// at most twice its magnitude.

#include "math/sampling.h"
#include "shading/lobes/fuzz_table.h"
#include "shading/lobes/layer_transmittance.h"

namespace pertev {

struct FuzzLobe {
    Rgb color;       // [0, 1]
    float roughness; // [fuzz_table::kRoughnessMin, 1]

    HD static float usable_roughness(float roughness) { return clamp(roughness, fuzz_table::kRoughnessMin, 1.0f); }

    HD LobeClass lobe_class() const { return LobeClass::Diffuse; }
    HD float energy() const { return max_component(color) * fuzz_table::node_at(roughness, 0.25f).albedo; }

    HD_CALL BsdfValue evaluate(Vec3 wo, Vec3 wi, float beneath, LayerTransmittance& transmittance) const {
        const float cos_o = abs(wo.z), cos_i = abs(wi.z), strength = max_component(color);
        const fuzz_table::Node o = fuzz_table::node_at(roughness, cos_o), i = fuzz_table::node_at(roughness, cos_i);
        const float p_beneath = probability_beneath(strength * o.albedo, beneath);
        BsdfValue value;
        if (wo.z * wi.z > 0) {
            const float along = wo.x * wi.x + wo.y * wi.y;
            const float o2 = wo.x * wo.x + wo.y * wo.y, i2 = wi.x * wi.x + wi.y * wi.y;
            const float density = density_over_cosine(o, o2, i2, along, cos_i);
            const float there = o.magnitude * density;
            const float back = i.magnitude * density_over_cosine(i, i2, o2, along, cos_o);
            const float both = there + back;
            const float f = both > 0 ? 2.0f * (there * back) / both * cos_i : 0.0f;
            value = {(transmittance.light * f) * color, transmittance.reach * ((1.0f - p_beneath) * density * cos_i)};
        }
        transmittance.pass(strength * o.albedo, strength * i.albedo, p_beneath);
        return value;
    }

    HD_CALL LobeDraw draw(Vec3 wo, float beneath, float u_lobe, Vec2 u) const {
        const fuzz_table::Node o = fuzz_table::node_at(roughness, abs(wo.z));
        const float p_beneath = probability_beneath(max_component(color) * o.albedo, beneath);
        if (u_lobe < p_beneath) return draw_beneath(u_lobe, p_beneath);
        const Vec3 cosine = sample_cosine_hemisphere(u);
        const float sine = sqrt(wo.x * wo.x + wo.y * wo.y);
        const float x = (cosine.x - o.shear_by_sine * sine * cosine.z) / o.scale, y = cosine.y / o.scale;
        const Vec2 side = sine > 1e-6f ? Vec2{wo.x / sine, wo.y / sine} : Vec2{1, 0};
        const Vec3 wi = normalize(Vec3{side.x * x - side.y * y, side.y * x + side.x * y, cosine.z});
        if (!(wi.z > 0)) return {};
        return draw_direction({wi.x, wi.y, copysign(wi.z, wo.z)});
    }

private:
    /// Density of the fit `of` a view with squared sine `view2` in a direction with squared sine `sine2`, over its
    /// `cosine`, 1/sr; `along` is the product of both horizontal parts.
    HD static float density_over_cosine(const fuzz_table::Node& of, float view2, float sine2, float along,
                                        float cosine) {
        const float a = of.scale, b = of.shear_by_sine;
        const float length2 =
            a * a * sine2 + 2.0f * a * b * along * cosine + (b * b * view2 + 1.0f) * (cosine * cosine);
        return kInvPi * (a * a) / (length2 * length2);
    }
    /// Probability of sampling what lies beneath, at most 15/16, because the energy seen from wo may not predict the
    /// value at wi.
    HD static float probability_beneath(float at_o, float beneath) {
        const float rest = beneath * (1.0f - at_o);
        return rest > 0 ? min(rest / (at_o + rest), 0.9375f) : 0.0f;
    }
};

} // namespace pertev
