#pragma once

// A coat on anything: a second, colourless dielectric interface with its own roughness and its own normal over a layer
// that may absorb. Layers beneath get at most what the coat transmits, from either side (LayerTransmittance::pass;
// rough metal also what it gets back, coated_table.h), tinted by the refracted way in and out (coat_absorption.h).
//
// Source: KHR_materials_clearcoat, whose layering by Fresnel's term of the view direction alone is not reciprocal;
// here the coat's directional albedo for both directions replaces it. A bent normal's value is 0 where that and the
// surface's own disagree on the side. For both directions it is reduced where the coat faces them less than the
// surface does, so that the value is reciprocal and, times either cosine, no larger than about the coat's normal.
// A stretched coat (coat_roughness_anisotropy of OpenPBR) is filmed_lobe.h's reflection of a dielectric alone.

#include "math/frame.h"
#include "math/portable_math.h"
#include "shading/lobes/coat_absorption.h"
#include "shading/lobes/coated_table.h"
#include "shading/lobes/filmed_lobe.h"
#include "shading/lobes/schlick_lobe.h"
#include "shading/lobes/unit_pair.h"

namespace pertev {

struct CoatLobe {
    float strength;                                         // [0, 1]: clearcoatFactor
    float alpha;                                            // GGX width = roughness^2, [0, 1]
    float f0;                                               // reflectance at normal incidence, [0, 1]: 0.04 in glTF
    Vec3 normal = {0, 0, 1};                                // unit, in the frame of the BSDF, z > 0
    UnitPair color_rg = {1, 1}, color_b_and_solid = {1, 0}; // its colour (coat_absorption.h), and 1 on a solid
    UnitPair wide_and_turn = {0, 0}; // a stretched coat's width along a tangent of its plane, else 0; the angle from x
                                     // to that tangent in half turns

    HD Rgb color() const { return {color_rg.low(), color_rg.high(), color_b_and_solid.low()}; }
    HD bool is_tinted() const { return color_rg.bits != ~0u || (color_b_and_solid.bits & 0xffffu) != 0xffffu; }
    HD SchlickLobe interface() const { return {grey(0), 0, alpha, f0}; }

    /// Stretches the coat's highlights along a tangent of the BSDF's frame. Its normal and width are those already set.
    HD_CALL void set_stretch(const Stretch& stretch) {
        if (!(stretch.anisotropy > 0)) return;
        Vec3 tangent = {stretch.along.x, stretch.along.y, 0};
        if (is_bent()) tangent = make_frame(normal).to_local(tangent);
        const float half_turns = atan2(tangent.y, tangent.x) * kInvPi;
        wide_and_turn = UnitPair(anisotropic_widths(alpha, stretch.anisotropy, {1, 0}).x,
                                 half_turns < 0 ? half_turns + 1.0f : half_turns);
    }

    HD LobeClass lobe_class() const { return interface().lobe_class(); }
    HD float energy() const { return strength * interface().energy(); }
    HD_CALL Gloss gloss(float cos_o) const {
        if (is_stretched()) return stretched().gloss(cos_o);
        const Gloss whole = interface().gloss(cos_o);
        return {strength * whole.reflectance, alpha, 1.0f - strength * (1.0f - whole.transmittance)};
    }
    HD_CALL SpecularBranches specular(Vec3 wo) const {
        SpecularBranches branches;
        if (interface().is_smooth()) branches.mirror = strength * fresnel_schlick(abs(wo.z), grey(f0));
        return branches;
    }

    HD_CALL BsdfValue evaluate(Vec3 wo, Vec3 wi, float beneath, LayerTransmittance& transmittance) const {
        Vec3 o = {wo.x, wo.y, abs(wo.z)}, i = {wi.x, wi.y, abs(wi.z)};
        bool reflects = wo.z * wi.z > 0;
        float facing = 1;
        if (is_bent()) {
            const Frame frame = make_frame(normal);
            o = frame.to_local(o);
            i = frame.to_local(i);
            reflects = reflects && o.z > 0 && i.z > 0;
            facing = factor_of_bend(abs(wo.z), o.z, abs(wi.z), i.z);
            o.z = min(abs(o.z), 1.0f);
            i.z = min(abs(i.z), 1.0f);
        }
        if (is_stretched()) {
            const FilmedLobe lobe = stretched();
            const float albedo = f0 + (1.0f - f0) * max(lobe.widths.schlick(lobe.widths.turned(o)),
                                                        lobe.widths.schlick(lobe.widths.turned(i)));
            if (is_tinted()) transmittance.tint = transmittance.tint * tint_of(wo, wi, o.z, i.z, albedo);
            if (!reflects) i.z = -i.z;
            const BsdfValue value = lobe.evaluate(o, i, beneath, transmittance);
            return {facing * value.f, value.pdf};
        }
        const SchlickLobe lobe = interface();
        const SchlickLobe::Average average = lobe.make_average();
        const SchlickLobe::Albedo at_o = lobe.albedo_at(o.z, average), at_i = lobe.albedo_at(i.z, average);
        const LayerShares shares = make_shares(average, at_o, beneath, o.z);
        BsdfValue value;
        if (!lobe.is_smooth() && reflects) {
            const GgxReflection once = evaluate_ggx_reflection(o, i, alpha);
            value = {(transmittance.light * strength * facing) * lobe.value_of(once, i.z, average, at_o, at_i),
                     transmittance.reach * lobe.pdf_of(once, i.z, shares.specular, shares.more)};
        }
        if (is_tinted()) transmittance.tint = transmittance.tint * tint_of(wo, wi, o.z, i.z, max(at_o.coat, at_i.coat));
        if (transmittance.metal_share > 0 && !is_bent()) {
            const float passed = max(1.0f - strength * max(at_o.coat, at_i.coat), 1e-6f);
            const float scale = transmittance.metal_share * strength * returned_by_coat_scale(alpha, f0);
            const float metal = transmittance.metal_alpha;
            transmittance.returned *=
                1.0f + scale * returned_by_coat(o.z, alpha, metal) * returned_by_coat(i.z, alpha, metal) / passed;
        }
        transmittance.pass(strength * at_o.coat, strength * at_i.coat, shares.beneath);
        return value;
    }

    /// Draws in the frame of the coat's normal, mirrored to the upper side together with wo.
    HD_CALL LobeDraw draw(Vec3 wo, float beneath, float u_lobe, Vec2 u) const {
        const bool bent = is_bent();
        Frame frame;
        Vec3 o = {wo.x, wo.y, abs(wo.z)};
        if (bent) {
            frame = make_frame(normal);
            o = frame.to_local(o);
        }
        LobeDraw draw = draw_above({o.x, o.y, bent ? min(abs(o.z), 1.0f) : o.z}, beneath, u_lobe, u);
        if (draw.is_beneath || !(draw.sample.pdf > 0)) return draw;
        Vec3& wi = draw.sample.wi;
        if (bent) {
            const float cos_i = wi.z;
            wi = normalize(frame.to_world(wi));
            if (!(o.z > 0 && cos_i > 0 && wi.z > 0)) return {};
            draw.sample.weight = factor_of_bend(abs(wo.z), o.z, wi.z, cos_i) * draw.sample.weight;
        }
        wi.z = copysign(wi.z, wo.z);
        return draw;
    }

private:
    /// Light crosses the coat of a solid once for each direction that is outside; a thin wall has a coat on both sides.
    HD_CALL Rgb tint_of(Vec3 wo, Vec3 wi, float coat_o, float coat_i, float albedo) const {
        const bool is_solid = color_b_and_solid.high() > 0;
        float length = 0;
        if (!is_solid || wo.z > 0) length += length_in_coat(coat_o, f0);
        if (!is_solid || wi.z > 0) length += length_in_coat(coat_i, f0);
        return coat_tint(color(), strength, 0.5f * length, albedo);
    }
    /// Factor on value times cosine about the coat's normal, for the cosines of both directions there (`coat_o`,
    /// `coat_i`) and about the surface's normal.
    HD static float factor_of_bend(float cos_o, float coat_o, float cos_i, float coat_i) {
        return min(1.0f, coat_o / cos_o) * min(1.0f, cos_i / coat_i);
    }
    HD bool is_bent() const { return normal.x != 0 || normal.y != 0; }
    HD bool is_stretched() const { return (wide_and_turn.bits & 0xffffu) != 0; }
    HD FilmedLobe stretched() const {
        Microfacets widths = {max(wide_and_turn.low(), alpha), alpha};
        sin_cos_2pi(0.5f * wide_and_turn.high(), widths.along.y, widths.along.x);
        return {
            .base_color = {}, .metallic = 0, .widths = widths, .f0 = grey(strength * f0), .f90 = strength, .film = {}};
    }

    /// Draws about the coat's normal, for wo.z >= 0.
    HD LobeDraw draw_above(Vec3 wo, float beneath, float u_lobe, Vec2 u) const {
        if (is_stretched()) return stretched().draw(wo, beneath, u_lobe, u);
        const SchlickLobe lobe = interface();
        const SchlickLobe::Average average = lobe.make_average();
        const LayerShares shares = make_shares(average, lobe.albedo_at(wo.z, average), beneath, wo.z);
        return lobe.draw_by(shares, strength * fresnel_schlick(wo.z, grey(f0)), wo, u_lobe, u);
    }
    HD LayerShares make_shares(const SchlickLobe::Average& average, const SchlickLobe::Albedo& at_o, float beneath,
                               float cos_o) const {
        const float once = strength * ((1.0f - at_o.lost) * (f0 + (1.0f - f0) * at_o.schlick));
        const float more = strength * (at_o.lost * average.coat_more);
        return layer_shares(once, more, beneath * (1.0f - strength * at_o.coat), raise_of_shares(cos_o, alpha, f0));
    }
};

} // namespace pertev
