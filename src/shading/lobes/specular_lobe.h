#pragma once

// The reflection of metallic-roughness with the weight and colour of KHR_materials_specular: as schlick_lobe.h, but the
// dielectric reflects min(f0 colour, 1) weight at normal and `weight` at grazing incidence. A lobe of its own, so that
// the common one stays small. The diffuse base gets what the channel with the largest reflectance leaves, in the
// reciprocal form of schlick_lobe.h (the extension's 1 - max(F) of the half vector is that of one microfacet).

#include "shading/lobes/schlick_lobe.h"

namespace pertev {

struct SpecularLobe {
    Rgb base_color; // [0, 1], the metal's reflectance at normal incidence
    float metallic; // [0, 1]
    float alpha;    // GGX width = roughness^2, [0, 1]
    Rgb f0;         // [0, f90], reflectance of the dielectric at normal incidence
    float f90;      // [0, 1], the same at grazing incidence

    struct Average {
        float lost;
        float coat;      // the dielectric's albedo
        float coat_more; // factor of the compensating lobe of its strongest channel
        Rgb more;        // factor of the compensating lobe, dielectric and metal mixed
    };
    using Albedo = SchlickLobe::Albedo;

    HD bool is_smooth() const { return !(alpha >= kSmoothAlpha); }
    HD LobeClass lobe_class() const { return is_smooth() ? LobeClass::Specular : LobeClass::Glossy; }
    HD float energy() const { return max_component(mixed_f0() + (1.0f / 21.0f) * (grey(mixed_f90()) - mixed_f0())); }
    HD_CALL Gloss gloss(float cos_o) const {
        const Average average = make_average();
        const Albedo at_o = albedo_at(cos_o, average);
        return {(1.0f - at_o.lost) * once_at(at_o.schlick) + at_o.lost * average.more, alpha, 1.0f - at_o.coat};
    }
    HD_CALL SpecularBranches specular(Vec3 wo) const {
        SpecularBranches branches;
        if (is_smooth()) branches.mirror = once_at(schlick_weight(abs(wo.z)));
        return branches;
    }

    HD_CALL BsdfValue evaluate(Vec3 wo, Vec3 wi, float beneath, LayerTransmittance& transmittance) const {
        const Vec3 o = {wo.x, wo.y, abs(wo.z)}, i = {wi.x, wi.y, abs(wi.z)};
        const Average average = make_average();
        const Albedo at_o = albedo_at(o.z, average), at_i = albedo_at(i.z, average);
        const LayerShares shares = make_shares(average, at_o, beneath, o.z);
        BsdfValue value;
        if (!is_smooth() && wo.z * wi.z > 0) {
            const GgxReflection once = evaluate_ggx_reflection(o, i, alpha);
            const Rgb more = (i.z * kInvPi * at_o.lost * at_i.lost / average.lost) * average.more;
            value = {transmittance.light_on_metal() * (once.f * once_at(schlick_weight(once.cos_h)) + more),
                     transmittance.reach * sampler().pdf_of(once, i.z, shares.specular, shares.more)};
        }
        transmittance.near = 1.0f - at_o.coat;
        transmittance.far = 1.0f - at_i.coat;
        transmittance.average = 1.0f - average.coat;
        transmittance.reach = transmittance.reach * shares.beneath;
        return value;
    }
    HD_CALL LobeDraw draw(Vec3 wo, float beneath, float u_lobe, Vec2 u) const {
        const Average average = make_average();
        const LayerShares shares = make_shares(average, albedo_at(abs(wo.z), average), beneath, abs(wo.z));
        return sampler().draw_by(shares, once_at(schlick_weight(abs(wo.z))), wo, u_lobe, u);
    }

private:
    HD SchlickLobe sampler() const { return {base_color, metallic, alpha, 0}; }
    HD Rgb mixed_f0() const { return lerp(f0, base_color, metallic); }
    HD float mixed_f90() const { return lerp(f90, 1.0f, metallic); }
    /// Reflectance of one bounce with Schlick's weight `w`.
    HD Rgb once_at(float w) const { return mixed_f0() + w * (grey(mixed_f90()) - mixed_f0()); }
    HD float average_of(float at_normal) const { return at_normal + (f90 - at_normal) * (1.0f / 21.0f); }

    HD Average make_average() const {
        Average a = {};
        a.lost = is_smooth() ? 0.0f : metal_average_lost(alpha);
        const float schlick = is_smooth() ? 1.0f / 21.0f : metal_average_schlick(alpha), most = max_component(f0);
        a.coat_more = multiple_scattering_tint(average_of(most), a.lost);
        a.coat = most * (1.0f - a.lost - schlick) + f90 * schlick + a.lost * a.coat_more;
        const Rgb of_f0 = multiple_scattering_tint({average_of(f0.r), average_of(f0.g), average_of(f0.b)}, a.lost);
        a.more = lerp(of_f0, multiple_scattering_tint(fresnel_schlick_average(base_color), a.lost), metallic);
        return a;
    }
    HD Albedo albedo_at(float cosine, const Average& average) const {
        Albedo a = {};
        a.lost = is_smooth() ? 0.0f : metal_lost(cosine, alpha);
        a.schlick = is_smooth() ? schlick_weight(cosine) : metal_schlick(cosine, alpha);
        const float most = max_component(f0);
        a.coat = min((1.0f - a.lost) * (most + (f90 - most) * a.schlick) + a.lost * average.coat_more, 1.0f);
        return a;
    }
    HD LayerShares make_shares(const Average& average, const Albedo& at_o, float beneath, float cos_o) const {
        const float once = (1.0f - at_o.lost) * max_component(once_at(at_o.schlick));
        return layer_shares(once, at_o.lost * max_component(average.more), beneath * (1.0f - at_o.coat),
                            raise_of_shares(cos_o, alpha, max_component(mixed_f0())));
    }
};

} // namespace pertev
