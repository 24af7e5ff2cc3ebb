#pragma once

// glTF 2.0 metallic-roughness (specification, appendix B): a metal and a coated diffuse base, mixed by `metallic`.
// Both reflect by one GGX lobe with Schlick's Fresnel; multiple scattering is compensated (energy_tables.h). The base
// under the coat gets (1 - C(o)) (1 - C(i)) / (1 - C_avg), C the coat's directional albedo (Kelemen & Szirmay-Kalos,
// "A Microfacet Based Coupled Specular-Matte BRDF Model", 2001), so coat and a white base together return all light.
// Below kSmoothAlpha the lobe is a perfect mirror beside the base. Both sides reflect alike.

#include "base/host_device.h"
#include "shading/bsdf_sample.h"
#include "shading/conductor_bsdf.h"
#include "shading/diffuse_bsdf.h"
#include "shading/energy_tables.h"
#include "shading/fresnel.h"
#include "shading/ggx.h"
#include "shading/grazing_lobe.h"

namespace pertev {

struct MetallicRoughnessBsdf {
    Rgb base_color; // [0, 1]
    float metallic; // [0, 1]
    float alpha;    // GGX width = roughness^2, [0, 1]
    float f0;       // reflectance of the coat at normal incidence, [0, 1]: f0_from_ior(ior)

    HD bool is_smooth() const { return !(alpha >= kSmoothAlpha); }
    HD bool has_base() const { return metallic < 1 && !is_black(base_color); }

    HD BsdfValue evaluate(Vec3 wo, Vec3 wi) const {
        if (!(wo.z * wi.z > 0)) return {};
        const Vec3 o = {wo.x, wo.y, abs(wo.z)}, i = {wi.x, wi.y, abs(wi.z)};
        const float cosine = i.z * kInvPi;
        const Lobes lobes = make_lobes(o.z);
        const Albedo at_i = albedo_at(i.z, lobes.average);
        BsdfValue value;
        if (has_base())
            value.f = (cosine * (1.0f - metallic) * (1.0f - lobes.at_o.coat) * (1.0f - at_i.coat) /
                       (1.0f - lobes.average.coat)) *
                      base_color;
        value.pdf = lobes.p_base * cosine;
        if (is_smooth()) return value;

        const GgxReflection once = evaluate_ggx_reflection(o, i, alpha);
        value.f += once.f * fresnel_schlick(once.cos_h, mixed_f0()) +
                   (cosine * lobes.at_o.lost * at_i.lost / lobes.average.lost) * lobes.average.more;
        value.pdf += lobes.p_specular * once.pdf + lobes.p_more * pdf_grazing_lobe(i.z, alpha);
        return value;
    }
    HD Rgb eval(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).f; }
    HD float pdf(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).pdf; }

    HD BsdfSample sample(Vec3 wo, float u_lobe, Vec2 u) const {
        if (wo.z == 0) return {};
        const Vec3 o = {wo.x, wo.y, abs(wo.z)};
        const Lobes lobes = make_lobes(o.z);
        Vec3 wi;
        if (u_lobe < lobes.p_base) {
            wi = sample_cosine_hemisphere(u);
        } else if (u_lobe - lobes.p_base < lobes.p_more) {
            wi = sample_grazing_lobe(alpha, u);
        } else if (is_smooth()) {
            return {.wi = {-wo.x, -wo.y, wo.z},
                    .weight = (1.0f / lobes.p_specular) * fresnel_schlick(o.z, mixed_f0()),
                    .pdf = lobes.p_specular,
                    .is_delta = true};
        } else {
            wi = normalize(reflect(o, sample_ggx_visible_normal(o, alpha, u)));
            if (!(wi.z > 0)) return {};
        }
        wi.z = copysign(wi.z, wo.z);
        return make_bsdf_sample(wi, evaluate(wo, wi));
    }

private:
    struct Average {
        float lost, schlick; // of the lobe with F = 1
        float coat_more;     // factor of the compensating lobe of the coat
        float coat;          // the coat's albedo
        Rgb more;            // factor of the compensating lobe, coat and metal mixed
    };
    struct Albedo {
        float lost, schlick; // of the lobe with F = 1; schlick is metal_schlick()
        float coat;          // of coat with compensation, [0, 1]
    };
    struct Lobes {
        Average average;
        Albedo at_o;
        // Probabilities of sampling a visible normal (or the mirror), the grazing lobe, a cosine lobe.
        float p_specular, p_more, p_base;
    };

    HD Rgb mixed_f0() const { return lerp(grey(f0), base_color, metallic); }

    HD Average make_average() const {
        Average a = {};
        a.lost = is_smooth() ? 0.0f : metal_average_lost(alpha);
        a.schlick = is_smooth() ? 1.0f / 21.0f : metal_average_schlick(alpha);
        a.coat_more = multiple_scattering_tint(fresnel_schlick_average(f0), a.lost);
        a.coat = f0 * (1.0f - a.lost - a.schlick) + a.schlick + a.lost * a.coat_more;
        const Rgb metal_more = multiple_scattering_tint(fresnel_schlick_average(base_color), a.lost);
        a.more = lerp(grey(a.coat_more), metal_more, metallic);
        return a;
    }
    HD Albedo albedo_at(float cosine, const Average& average) const {
        Albedo a = {};
        a.lost = is_smooth() ? 0.0f : metal_lost(cosine, alpha);
        a.schlick = is_smooth() ? schlick_weight(cosine) : metal_schlick(cosine, alpha);
        a.coat = min((1.0f - a.lost) * (f0 + (1.0f - f0) * a.schlick) + a.lost * average.coat_more, 1.0f);
        return a;
    }
    HD Lobes make_lobes(float cos_o) const {
        Lobes lobes = {};
        lobes.average = make_average();
        lobes.at_o = albedo_at(cos_o, lobes.average);
        const float specular_f0 = max_component(mixed_f0());
        const float once = (1.0f - lobes.at_o.lost) * (specular_f0 + (1.0f - specular_f0) * lobes.at_o.schlick);
        const float more = lobes.at_o.lost * max_component(lobes.average.more);
        const float base = (1.0f - metallic) * max_component(base_color) * (1.0f - lobes.at_o.coat);
        // The visible normals keep at least 1/16, against fireflies where the energy seen from wo is no guide to the
        // value at wi.
        lobes.p_specular = more + base > 0 ? max(once / (once + more + base), 0.0625f) : 1.0f;
        const float rest = more + base > 0 ? (1.0f - lobes.p_specular) / (more + base) : 0.0f;
        lobes.p_more = rest * more;
        lobes.p_base = rest * base;
        return lobes;
    }
};

} // namespace pertev
