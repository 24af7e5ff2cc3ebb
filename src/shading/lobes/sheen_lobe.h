#pragma once

// Velvet: upright fibres that appear bright at grazing angles. It is a layer that may lie on anything.
//
// Source: KHR_materials_sheen. D: Estevez & Kulla, "Production Friendly Microfacet Sheen BRDF", 2017; V: Neubelt &
// Pettineo, "Crafting a Next-Gen Material Pipeline for The Order: 1886", 2013. Narrow sheen of both creates energy
// (albedo E up to 2 at grazing), so value and albedo are divided by max(1, E(o), E(i)), which is reciprocal. E is
// tabulated over roughness from 0.2 to 1 and sqrt(mu) (sheen_table_data.h).

#include "math/portable_pow.h"
#include "math/sampling.h"
#include "shading/lobes/energy_tables.h"
#include "shading/lobes/layer_transmittance.h"
#include "shading/lobes/sheen_table_data.h"

namespace pertev {

struct SheenLobe {
    Rgb color;   // [0, 1]
    float alpha; // roughness^2, in [kRoughnessMin^2, 1] (usable_alpha)

    /// Alpha for a roughness, which is clamped to at least kRoughnessMin.
    HD static float usable_alpha(float roughness) { return square(clamp(roughness, sheen_table::kRoughnessMin, 1.0f)); }

    HD LobeClass lobe_class() const { return LobeClass::Diffuse; }
    HD float energy() const { return max_component(color) * min(albedo_at(0.25f), 1.0f); }

    HD_CALL BsdfValue evaluate(Vec3 wo, Vec3 wi, float beneath, LayerTransmittance& transmittance) const {
        const float cos_o = abs(wo.z), cos_i = abs(wi.z);
        const float albedo_o = albedo_at(cos_o), albedo_i = albedo_at(cos_i);
        const float strength = max_component(color);
        const float at_o = strength * min(albedo_o, 1.0f), at_i = strength * min(albedo_i, 1.0f);
        const float p_beneath = probability_beneath(at_o, beneath);
        BsdfValue value;
        if (wo.z * wi.z > 0) {
            const Vec3 sum = {wo.x + wi.x, wo.y + wi.y, wo.z + wi.z};
            const float sine2 = (sum.x * sum.x + sum.y * sum.y) / length_squared(sum);
            const float d = (2.0f + 1.0f / alpha) * (0.5f * kInvPi) * pow(min(sine2, 1.0f), 0.5f / alpha);
            const float f = d * cos_i / (4.0f * (cos_o + cos_i - cos_o * cos_i));
            value = {(transmittance.light * f / max(1.0f, max(albedo_o, albedo_i))) * color,
                     transmittance.reach * ((1.0f - p_beneath) * pdf_uniform_hemisphere())};
        }
        transmittance.pass(at_o, at_i, p_beneath);
        return value;
    }

    HD_CALL LobeDraw draw(Vec3 wo, float beneath, float u_lobe, Vec2 u) const {
        const float p_beneath = probability_beneath(max_component(color) * min(albedo_at(abs(wo.z)), 1.0f), beneath);
        if (u_lobe < p_beneath) return draw_beneath(u_lobe, p_beneath);
        Vec3 wi = sample_uniform_hemisphere(u);
        wi.z = copysign(wi.z, wo.z);
        return draw_direction(wi);
    }

private:
    /// Albedo E: the integral of D V cos(wi), seen at cosine `mu` in [0, 1].
    HD float albedo_at(float mu) const {
        using namespace sheen_table;
        const energy_table::Cell column = energy_table::make_cell(sqrt(mu), kMuNodes);
        const energy_table::Cell row =
            energy_table::make_cell((sqrt(alpha) - kRoughnessMin) * (1.0f / (1.0f - kRoughnessMin)), kRoughnessNodes);
        return energy_table::along([](int i) { return sheen_table::albedo_at(i); }, 0, row, column, kMuNodes);
    }
    /// Probability of sampling what lies beneath, at most 15/16, because the energy seen from wo may not predict the
    /// value at wi.
    HD static float probability_beneath(float at_o, float beneath) {
        const float rest = beneath * (1.0f - at_o);
        return rest > 0 ? min(rest / (at_o + rest), 0.9375f) : 0.0f;
    }
};

} // namespace pertev
