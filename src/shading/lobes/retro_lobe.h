#pragma once

// The reflection of metallic-roughness that sends a share of its light back where it came from, as glass beads do: that
// share is what the lobe without it reflects to the view's mirror image. It is reciprocal and keeps the energy of that
// lobe, because microfacets are symmetric about the normal. The surface is never perfectly smooth.
//
// Source: Portsmouth, Raab, Belcour, Liu, "The Minimal Retroreflective Microfacet Model", JCGT 15(1), 2026;
// KHR_materials_retroreflection (draft).

#include "shading/lobes/packed_lobes.h"
#include "shading/lobes/specular_lobe.h"

namespace pertev {

/// Sends back a share of what `Reflection`, SpecularLobe or FilmedLobe, reflects.
template <class Reflection>
struct RetroOf {
    Reflection lobe; // its widths are at least kSmoothAlpha
    float share;     // [0, 1], sent back

    HD LobeClass lobe_class() const { return LobeClass::Glossy; }
    HD float energy() const { return lobe.energy(); }
    HD Gloss gloss(float cos_o) const { return lobe.gloss(cos_o); }

    HD_CALL BsdfValue evaluate(Vec3 wo, Vec3 wi, float beneath, LayerTransmittance& transmittance) const {
        BsdfValue sum;
        const LayerTransmittance above = transmittance;
        for (int back = 0; back < 2; ++back) { // one call, because the lobe is large
            transmittance = above;
            const BsdfValue value = lobe.evaluate(back != 0 ? mirrored(wo) : wo, wi, beneath, transmittance);
            const float part = back != 0 ? share : 1.0f - share;
            sum = sum + BsdfValue{part * value.f, part * value.pdf};
        }
        return sum;
    }
    HD_CALL LobeDraw draw(Vec3 wo, float beneath, float u_lobe, Vec2 u) const {
        const bool is_back = !(share < 1) || u.x < share;
        u.x = min(is_back ? u.x / share : (u.x - share) / (1.0f - share), 0x1.fffffep-1f);
        return lobe.draw(is_back ? mirrored(wo) : wo, beneath, u_lobe, u);
    }

private:
    HD static Vec3 mirrored(Vec3 wo) { return {-wo.x, -wo.y, wo.z}; }
};

using RetroLobe = RetroOf<SpecularLobe>;

/// A reflection of any microfacets, with a metal's tint but without a film, of which a share is sent back.
using FilmedRetroLobe = RetroOf<FilmedLobe>;

struct PackedRetroLobe {
    UnitPair color_rg, color_b_metallic, f0_rg, f0_b_f90;
    float alpha, share;

    HD explicit PackedRetroLobe(const RetroLobe& of)
        : color_rg(of.lobe.base_color.r, of.lobe.base_color.g),
          color_b_metallic(of.lobe.base_color.b, of.lobe.metallic), f0_rg(of.lobe.f0.r, of.lobe.f0.g),
          f0_b_f90(of.lobe.f0.b, of.lobe.f90), alpha(of.lobe.alpha), share(of.share) {}
    HD RetroLobe unpacked() const {
        return {{{color_rg.low(), color_rg.high(), color_b_metallic.low()},
                 color_b_metallic.high(),
                 alpha,
                 {f0_rg.low(), f0_rg.high(), f0_b_f90.low()},
                 f0_b_f90.high()},
                share};
    }
};

struct PackedFilmedRetroLobe {
    UnitPair color_rg, color_b_metallic, f0_rg, f0_b_f90;
    PackedMicrofacets microfacets; // packed with the share
    UnitPair tint_rg, tint_b;

    HD explicit PackedFilmedRetroLobe(const FilmedRetroLobe& of)
        : color_rg(of.lobe.base_color.r, of.lobe.base_color.g),
          color_b_metallic(of.lobe.base_color.b, of.lobe.metallic), f0_rg(of.lobe.f0.r, of.lobe.f0.g),
          f0_b_f90(of.lobe.f0.b, of.lobe.f90), microfacets(of.lobe.widths, of.share),
          tint_rg(of.lobe.tint.r, of.lobe.tint.g), tint_b(of.lobe.tint.b, 0) {}
    HD FilmedRetroLobe unpacked() const {
        return {{{color_rg.low(), color_rg.high(), color_b_metallic.low()},
                 color_b_metallic.high(),
                 microfacets.widths(),
                 {f0_rg.low(), f0_rg.high(), f0_b_f90.low()},
                 f0_b_f90.high(),
                 {},
                 {tint_rg.low(), tint_rg.high(), tint_b.low()}},
                microfacets.more()};
    }
};

} // namespace pertev
