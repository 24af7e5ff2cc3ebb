#pragma once

// The reflection of metallic-roughness with stretched microfacets (KHR_materials_anisotropy), Beckmann's, single
// scattering, and a thin film (KHR_materials_iridescence) or, without one, a metal's F82 tint; else it is as
// specular_lobe.h. A lobe of its own, so that the common ones stay small.
//
// The layers beneath get 1 - max(C(o), C(i)) of the light, with the strongest channel's reflectance C by
// Microfacets::schlick(), or with a film its own at that angle: neither a film's colours nor stretched microfacets have
// an average that the form of schlick_lobe.h needs.

#include "shading/lobes/microfacets.h"
#include "shading/lobes/schlick_lobe.h"
#include "shading/lobes/thin_film.h"

namespace pertev {

struct FilmedLobe {
    Rgb base_color; // [0, 1], the metal's reflectance at normal incidence
    float metallic; // [0, 1]
    Microfacets widths;
    Rgb f0;    // [0, f90], reflectance of the dielectric at normal incidence
    float f90; // [0, 1], the same at grazing incidence
    ThinFilm film;
    Rgb tint = {1, 1, 1}; // [0, 1], of the metal at 82 degrees (fresnel_f82)

    struct Average {
        float lost; // for the lobe with F = 1
        Rgb more;   // factor of the compensating lobe, dielectric and metal mixed
    };
    struct Albedo {
        float lost;
        float coat;     // reflectance of the dielectric's strongest channel, [0, 1]
        float strength; // the strongest channel of the mixture's single scattering
    };

    HD bool is_smooth() const { return widths.is_smooth(); }
    HD LobeClass lobe_class() const { return is_smooth() ? LobeClass::Specular : LobeClass::Glossy; }
    HD float energy() const { return max_component(average_reflectance()); }
    HD_CALL Gloss gloss(float cos_o) const {
        const Average average = make_average();
        const float aside = safe_sqrt(0.5f * (1.0f - cos_o * cos_o)); // midway between both tangents
        const Albedo at_o = albedo_at({aside, aside, cos_o});
        return {(1.0f - at_o.lost) * reflectance(cos_o) + at_o.lost * average.more, widths.energy_width(),
                1.0f - at_o.coat};
    }
    HD_CALL SpecularBranches specular(Vec3 wo) const {
        SpecularBranches branches;
        if (is_smooth()) branches.mirror = reflectance(abs(wo.z));
        return branches;
    }

    HD_CALL BsdfValue evaluate(Vec3 wo, Vec3 wi, float beneath, LayerTransmittance& transmittance) const {
        const Vec3 o = widths.turned({wo.x, wo.y, abs(wo.z)}), i = widths.turned({wi.x, wi.y, abs(wi.z)});
        const Average average = make_average();
        const Albedo at_o = albedo_at(o), at_i = albedo_at(i);
        const LayerShares shares = make_shares(average, at_o, beneath, o.z);
        BsdfValue value;
        if (!is_smooth() && wo.z * wi.z > 0) {
            const GgxReflection once = widths.evaluate_reflection(o, i);
            const Rgb more = (i.z * kInvPi * at_o.lost * at_i.lost / max(average.lost, 1e-9f)) * average.more;
            value = {transmittance.light_on_metal() * (once.f * reflectance(once.cos_h) + more),
                     transmittance.reach * (shares.specular * once.pdf + shares.more * widths.pdf_lost_lobe(i.z))};
        }
        transmittance.pass(at_o.coat, at_i.coat, shares.beneath);
        return value;
    }
    HD_CALL LobeDraw draw(Vec3 wo, float beneath, float u_lobe, Vec2 u) const {
        const Average average = make_average();
        const LayerShares shares =
            make_shares(average, albedo_at(widths.turned({wo.x, wo.y, abs(wo.z)})), beneath, abs(wo.z));
        Vec3 wi;
        if (u_lobe < shares.beneath) return draw_beneath(u_lobe, shares.beneath);
        if (u_lobe - shares.beneath < shares.more) {
            wi = widths.sample_lost_lobe(u);
        } else if (is_smooth()) {
            return draw_mirror(wo, (1.0f / shares.specular) * reflectance(abs(wo.z)), shares.specular);
        } else {
            wi = widths.sample_reflection(wo, u);
            if (!(wi.z > 0)) return {};
        }
        wi.z = copysign(wi.z, wo.z);
        return draw_direction(wi);
    }

private:
    HD bool has_film() const { return film.weight > 0; }
    HD bool is_tinted() const { return !(tint == Rgb{1, 1, 1}) && !has_film(); }
    HD Rgb with_film(Rgb plain, float cosine, Rgb base_f0, float most) const {
        return has_film() ? beneath_film(plain, cosine, base_f0, most) : plain;
    }
    HD_CALL Rgb beneath_film(Rgb plain, float cosine, Rgb base_f0, float most) const {
        return plain + film.weight * (most * film_reflectance(cosine, film, ior_from_f0(base_f0)) - plain);
    }
    HD Rgb of_dielectric(float cosine) const {
        const Rgb plain = f0 + schlick_weight(cosine) * (grey(f90) - f0);
        return f90 > 0 ? with_film(plain, cosine, (1.0f / f90) * f0, f90) : plain;
    }
    HD Rgb of_metal(float cosine) const {
        if (is_tinted()) return fresnel_f82(cosine, base_color, tint);
        return with_film(fresnel_schlick(cosine, base_color), cosine, base_color, 1);
    }
    /// Reflectance of one bounce.
    HD Rgb reflectance(float cosine) const {
        if (!(metallic > 0)) return of_dielectric(cosine);
        if (!(metallic < 1)) return of_metal(cosine);
        return lerp(of_dielectric(cosine), of_metal(cosine), metallic);
    }
    HD Rgb average_of_dielectric() const {
        if (!has_film()) return f0 + (1.0f / 21.0f) * (grey(f90) - f0);
        return 0.36391724f * of_dielectric(0.35505103f) + 0.63608276f * of_dielectric(0.84494897f);
    }
    HD Rgb average_of_metal() const {
        if (!has_film()) return fresnel_f82_average(base_color, tint);
        return 0.36391724f * of_metal(0.35505103f) + 0.63608276f * of_metal(0.84494897f);
    }
    HD Rgb average_reflectance() const {
        if (!(metallic > 0)) return average_of_dielectric();
        if (!(metallic < 1)) return average_of_metal();
        return lerp(average_of_dielectric(), average_of_metal(), metallic);
    }

    HD Average make_average() const {
        Average a = {};
        a.lost = widths.average_lost();
        if (metallic < 1) a.more = multiple_scattering_tint(average_of_dielectric(), a.lost);
        if (metallic > 0) a.more = lerp(a.more, multiple_scattering_tint(average_of_metal(), a.lost), metallic);
        return a;
    }
    HD Albedo albedo_at(Vec3 view) const {
        const float cosine = view.z;
        Albedo a = {};
        a.lost = widths.lost(view);
        if (has_film()) {
            if (metallic < 1) a.coat = max_component(of_dielectric(cosine));
            a.strength = metallic > 0 ? lerp(a.coat, max_component(of_metal(cosine)), metallic) : a.coat;
            return a;
        }
        const float w = widths.schlick(view);
        const float most = max_component(f0);
        a.coat = most + (f90 - most) * w;
        const Rgb mixed = lerp(f0, base_color, metallic);
        a.strength = max_component(mixed + w * (grey(lerp(f90, 1.0f, metallic)) - mixed));
        return a;
    }
    HD LayerShares make_shares(const Average& average, const Albedo& at_o, float beneath, float cos_o) const {
        return layer_shares(
            (1.0f - at_o.lost) * at_o.strength, at_o.lost * max_component(average.more), beneath * (1.0f - at_o.coat),
            raise_of_shares(cos_o, widths.energy_width(), max_component(lerp(f0, base_color, metallic))));
    }
};

} // namespace pertev
