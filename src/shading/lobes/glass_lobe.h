#pragma once

// A share of glass in a solid: a layer on an opaque BSDF, which has the rest (KHR_materials_transmission with a volume,
// where the transmission is neither 0 nor 1), and glass with stretched or Beckmann microfacets or a thin film. It is as
// dielectric_lobe.h, which has the rules of refraction; all glass without those stays there.
//
// The film reflects as from outside on both sides, by the angle there, so refraction stays reciprocal.
//
// With dispersion each channel has an index of its own: a sample draws a channel and then a direction by its index, and
// the density is the mean of the three, so that no channel's weight exceeds three times that of clear glass.

#include "shading/lobes/dielectric_lobe.h"
#include "shading/lobes/microfacets.h"
#include "shading/lobes/thin_film.h"

namespace pertev {

struct GlassLobe {
    Rgb tint;     // factor on transmitted light, [0, 1]
    float weight; // [0, 1], of the light that meets glass
    Microfacets widths;
    float ior; // inside over outside, as DielectricLobe::usable_ior
    ThinFilm film;
    float spread = 0; // dispersion: blue's index less green's, and green's less red's

    HD bool is_smooth() const { return widths.is_smooth() || ior == 1; }
    HD LobeClass lobe_class() const { return is_smooth() ? LobeClass::Specular : LobeClass::Glossy; }
    HD float energy() const { return weight; }
    HD Gloss gloss(float) const { return {grey(weight), widths.energy_width(), 1.0f - weight}; }
    HD_CALL SpecularBranches specular(Vec3 wo) const {
        SpecularBranches branches;
        if (!is_smooth()) return branches; // dispersed light is taken to go along green's direction
        const Interface at = interface(wo, min(abs(wo.z), 1.0f));
        branches.mirror = weight * at.reflectance;
        if (!at.is_passed) return branches;
        branches.refraction = weight * (grey(1) - at.reflectance) * tint;
        branches.refracted = refracted(wo, at.cos_t);
        return branches;
    }

    HD_CALL BsdfValue evaluate(Vec3 wo, Vec3 wi, float beneath, LayerTransmittance& transmittance) const {
        const float p_beneath = probability_beneath(beneath);
        BsdfValue value;
        if (!is_smooth() && abs(wo.z) > 0 && abs(wi.z) > 0) {
            value = evaluate_channels(wo, wi);
            value = {(transmittance.light_of_delta() * weight) * value.f,
                     transmittance.reach * ((1.0f - p_beneath) * value.pdf)};
        }
        transmittance.light = transmittance.light * (1.0f - weight);
        transmittance.reach = transmittance.reach * p_beneath;
        return value;
    }

    HD_CALL LobeDraw draw(Vec3 wo, float beneath, float u_lobe, Vec2 u) const {
        const float p_beneath = probability_beneath(beneath);
        if (u_lobe < p_beneath) return draw_beneath(u_lobe, p_beneath);
        const float u_glass = min((u_lobe - p_beneath) / (1.0f - p_beneath), 0x1.fffffep-1f);
        if (spread > 0) {
            const float at = 3.0f * u_glass;
            const int channel = to_int(at, 0, 2);
            const float u_rest = min(at - static_cast<float>(channel), 0x1.fffffep-1f);
            if (is_smooth()) return draw_smooth_channel(channel, wo, u_rest, 1.0f - p_beneath);
            return of_channel(channel).draw_glass(wo, u_rest, 1.0f - p_beneath, u);
        }
        return draw_glass(wo, u_glass, 1.0f - p_beneath, u);
    }

    /// The glass of one channel's index, without dispersion.
    HD GlassLobe of_channel(int channel) const {
        GlassLobe one = *this;
        one.ior = DielectricLobe::usable_ior(ior + static_cast<float>(channel - 1) * spread, widths.y);
        one.spread = 0;
        return one;
    }

private:
    /// Draws from the glass alone, without dispersion.
    HD LobeDraw draw_glass(Vec3 wo, float u_glass, float reach, Vec2 u) const {
        if (is_smooth()) return draw_smooth(wo, u_glass, reach);
        const float eta = eta_from(wo);
        const Vec3 o = widths.turned({wo.x, wo.y, abs(wo.z)});
        Vec3 i;
        const float lost = lost_at(o, eta);
        if (u_glass < lost) {
            const float share = share_of_lost(eta);
            i = widths.sample_lost_lobe(u, true);
            if (u_glass < lost * share) i.z = -i.z;
        } else {
            const Vec3 m = widths.sample_visible_normal(o, u);
            const float cos_m = clamp(dot(o, m), 0.0f, 1.0f);
            const Interface at = interface(wo, cos_m);
            if (u_glass - lost < (1.0f - lost) * at.chance) {
                i = normalize(widths.turned_back(reflect(o, m)));
                if (!(i.z > 0)) return {};
            } else {
                i = normalize(widths.turned_back((cos_m / eta - at.cos_t) * m - (1.0f / eta) * o));
                if (!(i.z < 0)) return {};
            }
        }
        return draw_direction({i.x, i.y, wo.z < 0 ? -i.z : i.z}, i.z < 0);
    }
    /// The interface for light at a microfacet.
    struct Interface {
        Rgb reflectance;
        float cos_t;    // cosine of refraction
        float chance;   // probability that a sample is reflected
        bool is_passed; // there is refraction
    };
    HD BsdfValue evaluate_channels(Vec3 wo, Vec3 wi) const {
        const bool is_refracted = wo.z * wi.z < 0;
        if (!(spread > 0)) return is_refracted ? evaluate_refraction(wo, wi) : evaluate_reflection(wo, wi);
        Rgb f = {};
        float pdf = 0;
        for (int channel = 0; channel < 3; ++channel) {
            const GlassLobe one = of_channel(channel);
            const BsdfValue value = is_refracted ? one.evaluate_refraction(wo, wi) : one.evaluate_reflection(wo, wi);
            f += value.f * channel_alone(channel);
            pdf += (1.0f / 3.0f) * value.pdf;
        }
        return {f, pdf};
    }
    HD static Rgb channel_alone(int channel) {
        return {channel == 0 ? 1.0f : 0.0f, channel == 1 ? 1.0f : 0.0f, channel == 2 ? 1.0f : 0.0f};
    }
    /// Draws as draw_smooth(), with dispersion. All channels mirror in one direction and refract in three.
    HD LobeDraw draw_smooth_channel(int channel, Vec3 wo, float u, float reach) const {
        const GlassLobe one = of_channel(channel);
        const float cosine = min(abs(wo.z), 1.0f);
        const Interface at = one.interface(wo, cosine);
        if (u < at.chance) {
            Rgb reflected = {};
            float chance = 0;
            for (int i = 0; i < 3; ++i) {
                const Interface other = of_channel(i).interface(wo, cosine);
                reflected += other.reflectance * channel_alone(i);
                chance += (1.0f / 3.0f) * other.chance;
            }
            return draw_mirror(wo, (weight / (reach * chance)) * reflected, reach * chance);
        }
        if (!at.is_passed) return {};
        const float chance = (1.0f / 3.0f) * (1.0f - at.chance);
        return {.sample = {.wi = one.refracted(wo, at.cos_t),
                           .weight = (weight / (reach * chance)) *
                                     ((grey(1) - at.reflectance) * tint * channel_alone(channel)),
                           .pdf = reach * chance,
                           .is_transmission = true}};
    }
    HD float eta_from(Vec3 wo) const { return wo.z > 0 ? ior : 1.0f / ior; }
    HD Interface interface(Vec3 wo, float cos_m) const {
        const DielectricFresnel fresnel = fresnel_dielectric(cos_m, eta_from(wo));
        if (!(fresnel.cos_t > 0)) return {{1, 1, 1}, 0, 1, false};
        const Rgb r = with_film(fresnel.reflectance, wo.z > 0 ? cos_m : fresnel.cos_t);
        const float chance = (1.0f / 3.0f) * (r.r + r.g + r.b);
        return {r, fresnel.cos_t, chance, chance < 1};
    }
    /// Returns the reflectance with the film, for the reflectance `plain` without it. `cosine` is that of the direction
    /// outside.
    HD Rgb with_film(float plain, float cosine) const {
        if (!(film.weight > 0)) return grey(plain);
        return grey(plain) + film.weight * (film_reflectance(cosine, film, grey(max(ior, 1.0f))) - grey(plain));
    }
    HD Vec3 refracted(Vec3 wo, float cos_t) const {
        const float eta = eta_from(wo);
        return normalize(Vec3{-wo.x / eta, -wo.y / eta, -copysign(cos_t, wo.z)});
    }
    HD float probability_beneath(float beneath) const {
        const float rest = (1.0f - weight) * beneath;
        return rest > 0 ? rest / (rest + weight) : 0.0f;
    }
    /// A film changes the share that is reflected, and thus less is lost than the tables have. Through one on a bubble
    /// (an index below 1) nothing is lost from within at some angles, and from outside 0.42 of what they have or more.
    HD float lost_at(Vec3 w, float eta) const {
        const float not_lost = ior > 1 ? 0.5f : eta < 1 ? 0.35f : 1.0f;
        return (1.0f - not_lost * film.weight) * widths.glass_loss(w, eta);
    }
    HD float share_of_lost(float eta) const {
        return DielectricLobe::transmitted_share(eta, widths.average_glass_loss(eta),
                                                 widths.average_glass_loss(1.0f / eta));
    }

    HD BsdfValue evaluate_reflection(Vec3 wo, Vec3 wi) const {
        const float eta = eta_from(wo);
        const Vec3 o = widths.turned({wo.x, wo.y, abs(wo.z)}), i = widths.turned({wi.x, wi.y, abs(wi.z)});
        const float lost_o = lost_at(o, eta), average = widths.average_glass_loss(eta);
        const float stays = 1.0f - share_of_lost(eta);
        const GgxReflection once = widths.evaluate_reflection(o, i);
        const Interface at = interface(wo, once.cos_h);
        const float more = i.z * kInvPi * (stays * lost_o * lost_at(i, eta) / average);
        return {once.f * at.reflectance + grey(more),
                (1.0f - lost_o) * at.chance * once.pdf + lost_o * stays * widths.pdf_lost_lobe(i.z, true)};
    }
    HD BsdfValue evaluate_refraction(Vec3 wo, Vec3 wi) const {
        const float eta = eta_from(wo), cos_o = abs(wo.z), cos_i = abs(wi.z);
        const float lost_o = lost_at(widths.turned(wo), eta), share = share_of_lost(eta);
        const float far_lost = lost_at(widths.turned(wi), 1.0f / eta),
                    far_average = widths.average_glass_loss(1.0f / eta);
        Rgb f = grey(share * lost_o * far_lost / far_average * (cos_i * kInvPi));
        float pdf = lost_o * share * widths.pdf_lost_lobe(cos_i, true);
        const bool outside = wo.z > 0; // a is the outside's direction, as in DielectricLobe
        const Vec3 a = outside ? wo : wi, b = outside ? wi : wo;
        const Vec3 sum = a + ior * b;
        const float length2 = length_squared(sum);
        const Vec3 h = ((ior > 1 ? -1.0f : 1.0f) / sqrt(length2)) * sum;
        const float ah = min(dot(a, h), 1.0f), bh = min(-dot(b, h), 1.0f);
        if (ah > 0 && bh > 0 && h.z > 0) {
            const float so = widths.slope_length(widths.turned(wo)), si = widths.slope_length(widths.turned(wi));
            const float d =
                2.0f * widths.normals(widths.turned(h)) * ah * bh * ((outside ? ior * ior : 1.0f) / length2);
            const float plain = transmittance_dielectric(ah, bh, ior);
            const Rgb passed = film.weight > 0 ? grey(1) - with_film(1.0f - plain, ah) : grey(plain);
            f += (d * cos_i / (so * cos_i + si * cos_o)) * passed;
            pdf += (1.0f - lost_o) * (d / (cos_o + so)) * (1.0f / 3.0f) * (passed.r + passed.g + passed.b);
        }
        return {f * tint, pdf};
    }
    HD LobeDraw draw_smooth(Vec3 wo, float u, float reach) const {
        const Interface at = interface(wo, min(abs(wo.z), 1.0f));
        if (u < at.chance) {
            return draw_mirror(wo, (weight / (reach * at.chance)) * at.reflectance, reach * at.chance);
        }
        if (!at.is_passed) return {};
        const float chance = 1.0f - at.chance;
        return {.sample = {.wi = refracted(wo, at.cos_t),
                           .weight = (weight / (reach * chance)) * ((grey(1) - at.reflectance) * tint),
                           .pdf = reach * chance,
                           .is_transmission = true}};
    }
};

} // namespace pertev
