#pragma once

// Velvet: upright fibres that appear bright at grazing angles. It is a layer that may lie on anything.
//
// Source: KHR_materials_sheen. D: Estevez & Kulla, "Production Friendly Microfacet Sheen BRDF", 2017; V: Neubelt &
// Pettineo, "Crafting a Next-Gen Material Pipeline for The Order: 1886", 2013. Narrow sheen of both creates energy
// (albedo E up to 2 at grazing), so value and albedo are divided by max(1, E(o), E(i)), which is reciprocal. E is
// tabulated over roughness from 0.2 to 1 and sqrt(mu) (sheen_table_data.h).
//
// Directions are drawn by a mixture of three densities, whose numbers a search over roughness and angle has found
// (tools/fit_sheen_sampling.py): the band near the horizon that a grazing view sees, a transformed cosine for the views
// above it, and a uniform one.

#include "math/portable_pow.h"
#include "math/sampling.h"
#include "shading/lobes/beckmann.h"
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
                     transmittance.reach * ((1.0f - p_beneath) * Mixture(alpha, wo).pdf(wi))};
        }
        transmittance.pass(at_o, at_i, p_beneath);
        return value;
    }

    HD_CALL LobeDraw draw(Vec3 wo, float beneath, float u_lobe, Vec2 u) const {
        const float p_beneath = probability_beneath(max_component(color) * min(albedo_at(abs(wo.z)), 1.0f), beneath);
        if (u_lobe < p_beneath) return draw_beneath(u_lobe, p_beneath);
        Vec3 wi = Mixture(alpha, wo).sample((u_lobe - p_beneath) / (1.0f - p_beneath), u);
        wi.z = copysign(wi.z, wo.z);
        return draw_direction(wi);
    }

private:
    /// The density by which directions are drawn, on the side of wo with z upwards.
    struct Mixture {
        float x, y, sine;    // components of wo and its sine, never 0
        float uniform, band; // probabilities; the transformed cosine has the rest
        float width;         // width of the band's cosines at the azimuth of wo
        float scale, shear;  // transform: w goes to (scale w.x + shear x w.z, scale w.y + shear y w.z, w.z)

        HD Mixture(float alpha, Vec3 wo) : x(wo.x), y(wo.y), sine(sqrt(x * x + y * y)) {
            if (!(sine > 1e-6f)) x = sine = 1e-6f, y = 0;
            const float roughness = sqrt(alpha), z = abs(wo.z);
            uniform = 0.55f * max(roughness - sheen_table::kRoughnessMin, 0.0f);
            band = (1.0f - uniform) * alpha / (alpha * (1.0f + 0.2f * roughness) + z * (0.06f + 1.94f * z));
            width = roughness * (2.9f - 0.1f * roughness);
            scale = 0.17f + roughness - 0.18f * z;
            shear = 1.45f * roughness - 0.85f - sqrt(z) * (0.43f + 0.7f * roughness);
        }

        HD Vec3 sample(float u_kind, Vec2 u) const {
            const bool is_uniform = u_kind < uniform;
            if (!is_uniform && u_kind - uniform < band) {
                const float half = 2.0f * u.x - 1.0f, cosine = sqrt(1.0f - half * half); // sine is half
                const float spread = spread_of(cosine);
                const float z = min(spread * beckmann::erf_inverse(u.y * beckmann::erf(1.0f / spread)), 1.0f);
                const float radius = sqrt(1.0f - z * z) / sine, across = radius * (2.0f * half * cosine),
                            along = radius * (1.0f - 2.0f * half * half);
                return {x * along - y * across, y * along + x * across, z};
            }
            // A uniform direction is one that no transform moves, at another height.
            const PolarPoint p = sample_disk_polar(u);
            const float r2 = p.radius * p.radius, root = sqrt((is_uniform ? 2.0f : 1.0f) - r2);
            const float z = is_uniform ? 1.0f - r2 : root, radius = is_uniform ? p.radius * root : p.radius;
            const float moved = is_uniform ? 0.0f : shear * z, inv = 1.0f / (is_uniform ? 1.0f : scale);
            return normalize(Vec3{(radius * p.cosine - moved * x) * inv, (radius * p.sine - moved * y) * inv, z});
        }
        HD float pdf(Vec3 wi) const {
            const float z = abs(wi.z), i2 = wi.x * wi.x + wi.y * wi.y, along = x * wi.x + y * wi.y;
            const float cosine = along / max(sine * sqrt(i2), 1e-12f);
            const float inv_spread = 1.0f / spread_of(sqrt(clamp(0.5f + 0.5f * cosine, 0.0f, 1.0f)));
            const float of_band =
                (0.5f * beckmann::kInvSqrtPi) * exp(-square(z * inv_spread)) / (width * beckmann::erf(inv_spread));
            const float length2 = scale * scale * i2 + 2.0f * scale * shear * along * z +
                                  (shear * shear * (sine * sine) + 1.0f) * (z * z);
            const float of_cosine = kInvPi * (scale * scale) * z / (length2 * length2);
            return uniform * pdf_uniform_hemisphere() + band * of_band + (1.0f - uniform - band) * of_cosine;
        }

    private:
        /// Width of the band's cosines at an azimuth from that of wo, half of which has the cosine `of_half`.
        HD float spread_of(float of_half) const { return width * max(of_half, 1e-3f); }
    };

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
