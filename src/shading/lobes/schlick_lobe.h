#pragma once

// The reflection of glTF 2.0's metallic-roughness model (specification, appendix B): metal and dielectric coat, mixed
// by `metallic`, as one GGX lobe with Schlick's Fresnel; multiple scattering is compensated (energy_tables.h). It is
// a layer whose coat lies on a diffuse base or on nothing. The base gets (1 - C(o)) (1 - C(i)) / (1 - C_avg) with the
// coat's directional albedo C (Kelemen & Szirmay-Kalos, "A Microfacet Based Coupled Specular-Matte BRDF Model",
// 2001), so that coat and a white base together return all light. Below kSmoothAlpha it is a perfect mirror. Both
// sides reflect equally.

#include "base/host_device.h"
#include "shading/lobes/energy_tables.h"
#include "shading/lobes/fresnel.h"
#include "shading/lobes/ggx.h"
#include "shading/lobes/grazing_lobe.h"
#include "shading/lobes/layer_transmittance.h"

namespace pertev {

/// Probabilities of sampling a layer's visible normal (or its mirror direction), its grazing lobe, and what lies
/// beneath.
template <class T>
struct LayerSharesOf {
    T specular, more, beneath;
};
using LayerShares = LayerSharesOf<float>;
/// Computes the shares from the energies seen from wo. Visible normals keep at least 1/16, against fireflies where
/// the energy seen from wo does not predict the value at wi, and their share s is raised by `raise` s (1 - s)^2.
template <class T>
HD inline LayerSharesOf<T> layer_shares(T once, T more, T beneath, T raise) {
    const MaskOf<T> has_rest = more + beneath > 0;
    LayerSharesOf<T> shares = {};
    const T mean = once / (once + more + beneath);
    shares.specular = select(has_rest, max(mean + raise * (mean * square(1.0f - mean)), T(0.0625f)), T(1.0f));
    const T rest = select(has_rest, (1.0f - shares.specular) / (more + beneath), T(0.0f));
    shares.more = rest * more;
    shares.beneath = rest * beneath;
    return shares;
}

/// Returns the `raise` of a lobe seen at `cosine`, in [0, 2.1]. Seen at a grazing angle, a rough dielectric reflects a
/// tenth of the light on the mean, but nearly all where it leaves at a grazing angle too: drawn by the mean, it has
/// weights of 6.
template <class T>
HD inline T raise_of_shares(T cosine, T alpha, T f0) {
    return 2.1f * schlick_weight(cosine) * (alpha * (2.0f - alpha)) * (1.0f - f0);
}

/// `T` is float, or several floats at once on the host (math/lanes.h), for lobes that are not smooth.
template <class T>
struct SchlickLobeOf {
    RgbOf<T> base_color; // [0, 1], the metal's reflectance at normal incidence
    T metallic;          // [0, 1]
    T alpha;             // GGX width = roughness^2, [0, 1]
    T f0;                // reflectance of the coat at normal incidence, [0, 1]: f0_from_ior(ior)

    struct Average {
        T lost, schlick; // for the lobe with F = 1
        T coat_more;     // factor of the compensating lobe of the coat
        T coat;          // the coat's albedo
        RgbOf<T> more;   // factor of the compensating lobe, coat and metal mixed
    };
    struct Albedo {
        T lost, schlick; // for the lobe with F = 1; schlick is metal_schlick()
        T coat;          // albedo of the compensated coat, [0, 1]
    };

    HD bool is_smooth() const { return any(!(alpha >= kSmoothAlpha)); }
    HD LobeClass lobe_class() const { return is_smooth() ? LobeClass::Specular : LobeClass::Glossy; }
    HD float energy() const { return max_component(fresnel_schlick_average(mixed_f0())); }
    HD Gloss gloss(float cos_o) const {
        const Average average = make_average();
        const Albedo at_o = albedo_at(cos_o, average);
        const Rgb f0s = mixed_f0(), once = (1.0f - at_o.lost) * (f0s + at_o.schlick * (grey(1) - f0s));
        return {once + at_o.lost * average.more, alpha, 1.0f - at_o.coat};
    }
    HD SpecularBranches specular(Vec3 wo) const {
        SpecularBranches branches;
        if (is_smooth()) branches.mirror = fresnel_schlick(abs(wo.z), mixed_f0());
        return branches;
    }
    HD RgbOf<T> mixed_f0() const { return lerp(RgbOf<T>{f0, f0, f0}, base_color, metallic); }

    HD BsdfValue evaluate(Vec3 wo, Vec3 wi, float beneath, LayerTransmittance& transmittance) const {
        if (!(wo.z * wi.z > 0)) return {};
        const Vec3 o = {wo.x, wo.y, abs(wo.z)}, i = {wi.x, wi.y, abs(wi.z)};
        const Average average = make_average();
        const Albedo at_o = albedo_at(o.z, average), at_i = albedo_at(i.z, average);
        const LayerShares shares = make_shares(average, at_o, beneath, o.z);
        BsdfValue value;
        if (!is_smooth()) {
            const GgxReflection once = evaluate_ggx_reflection(o, i, alpha);
            value = {transmittance.light_on_metal() * value_of(once, i.z, average, at_o, at_i),
                     transmittance.reach * pdf_of(once, i.z, shares.specular, shares.more)};
        }
        transmittance.near = 1.0f - at_o.coat;
        transmittance.far = 1.0f - at_i.coat;
        transmittance.average = 1.0f - average.coat;
        transmittance.reach = transmittance.reach * shares.beneath;
        return value;
    }

    HD LobeDraw draw(Vec3 wo, float beneath, float u_lobe, Vec2 u) const {
        const Average average = make_average();
        const LayerShares shares = make_shares(average, albedo_at(abs(wo.z), average), beneath, abs(wo.z));
        return draw_by(shares, fresnel_schlick(abs(wo.z), mixed_f0()), wo, u_lobe, u);
    }

    // coat_lobe.h uses the following functions too.

    HD RgbOf<T> value_of(const GgxReflectionOf<T>& once, T cos_i, const Average& average, const Albedo& at_o,
                         const Albedo& at_i) const {
        const T cosine = cos_i * kInvPi;
        return once.f * fresnel_schlick<T>(once.cos_h, mixed_f0()) +
               (cosine * at_o.lost * at_i.lost / average.lost) * average.more;
    }
    HD T pdf_of(const GgxReflectionOf<T>& once, T cos_i, T p_specular, T p_more) const {
        return p_specular * once.pdf + p_more * pdf_metal_lost(cos_i, alpha);
    }

    /// Samples the lobe by given shares. `fresnel` is the mirror's reflectance seen from wo.
    HD LobeDraw draw_by(const LayerShares& shares, Rgb fresnel, Vec3 wo, float u_lobe, Vec2 u) const {
        Vec3 wi;
        if (u_lobe < shares.beneath) return draw_beneath(u_lobe, shares.beneath);
        if (u_lobe - shares.beneath < shares.more) {
            wi = sample_metal_lost(alpha, u);
        } else if (is_smooth()) {
            return draw_mirror(wo, (1.0f / shares.specular) * fresnel, shares.specular);
        } else {
            const Vec3 o = {wo.x, wo.y, abs(wo.z)};
            wi = normalize(reflect(o, sample_ggx_visible_normal(o, alpha, u)));
            if (!(wi.z > 0)) return {};
        }
        wi.z = copysign(wi.z, wo.z);
        return draw_direction(wi);
    }

    HD Average make_average() const {
        Average a = {};
        a.lost = is_smooth() ? T(0.0f) : metal_average_lost(alpha);
        a.schlick = is_smooth() ? T(1.0f / 21.0f) : metal_average_schlick(alpha);
        a.coat_more = multiple_scattering_tint(fresnel_schlick_average(f0), a.lost);
        a.coat = f0 * (1.0f - a.lost - a.schlick) + a.schlick + a.lost * a.coat_more;
        const RgbOf<T> metal_more = multiple_scattering_tint(fresnel_schlick_average(base_color), a.lost);
        a.more = lerp(RgbOf<T>{a.coat_more, a.coat_more, a.coat_more}, metal_more, metallic);
        return a;
    }
    HD Albedo albedo_at(T cosine, const Average& average) const {
        Albedo a = {};
        a.lost = is_smooth() ? T(0.0f) : metal_lost(cosine, alpha);
        a.schlick = is_smooth() ? schlick_weight(cosine) : metal_schlick(cosine, alpha);
        a.coat = min((1.0f - a.lost) * (f0 + (1.0f - f0) * a.schlick) + a.lost * average.coat_more, T(1.0f));
        return a;
    }
    HD LayerSharesOf<T> make_shares(const Average& average, const Albedo& at_o, T beneath, T cos_o) const {
        const T specular_f0 = max_component(mixed_f0());
        const T once = (1.0f - at_o.lost) * (specular_f0 + (1.0f - specular_f0) * at_o.schlick);
        const T more = at_o.lost * max_component(average.more);
        return layer_shares<T>(once, more, beneath * (1.0f - at_o.coat), raise_of_shares(cos_o, alpha, specular_f0));
    }
};

using SchlickLobe = SchlickLobeOf<float>;

} // namespace pertev
