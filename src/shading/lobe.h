#pragma once

// A lobe of any kind, as one plain struct. A new kind needs a member and a case in each switch (the compiler names the
// missing ones).

#include <cstdint>

#include "base/host_device.h"
#include "shading/lobes/bsdf_sample.h"
#include "shading/lobes/coat_lobe.h"
#include "shading/lobes/conductor_lobe.h"
#include "shading/lobes/dielectric_lobe.h"
#include "shading/lobes/diffuse_lobe.h"
#include "shading/lobes/fuzz_lobe.h"
#include "shading/lobes/packed_lobes.h"
#include "shading/lobes/retro_lobe.h"
#include "shading/lobes/rough_diffuse_lobe.h"
#include "shading/lobes/schlick_lobe.h"
#include "shading/lobes/sheen_lobe.h"
#include "shading/lobes/specular_lobe.h"
#include "shading/lobes/thin_lobe.h"
#include "shading/lobes/translucent_lobe.h"

namespace pertev {

enum class LobeKind : uint8_t {
    None,         // base that absorbs everything
    Diffuse,      // base
    RoughDiffuse, // base of called functions alone
    Conductor,    // base
    Metal,        // base of called functions alone
    Dielectric,   // base
    Schlick,      // layer on a base that is diffuse or None
    Specular,     // layer on a base that is diffuse or None, and on Thin and Translucent
    Filmed,       // layer as Specular, with a film or stretched
    Retro,        // layer as Specular, sends a share back
    FilmedRetro,  // layer as Retro, of any microfacets
    Thin,         // layer on a base that is diffuse or None
    Translucent,  // layer on a base that is diffuse or None, and on Thin
    Glass,        // layer on anything
    Coat,         // layer on anything
    Sheen,        // layer on anything
    Fuzz,         // layer on anything
};

/// A lobe of any kind.
struct Lobe {
    LobeKind kind;
    float beneath; // for a layer: energy of everything beneath it, [0, 1]
    union {
        DiffuseLobe diffuse;
        RoughDiffuseLobe rough_diffuse;
        ConductorLobe conductor;
        PackedMetalLobe metal;
        DielectricLobe dielectric;
        SchlickLobe schlick;
        SpecularLobe reflection;
        PackedFilmedLobe filmed;
        PackedRetroLobe retro;
        PackedFilmedRetroLobe filmed_retro;
        ThinLobe thin;
        TranslucentLobe translucent;
        PackedGlassLobe glass;
        CoatLobe coat;
        SheenLobe sheen;
        FuzzLobe fuzz;
    };

    HD Lobe() : kind(LobeKind::None) {} // NOLINT(cppcoreguidelines-pro-type-member-init): nothing else is read
    HD Lobe(const DiffuseLobe& lobe) : kind(LobeKind::Diffuse), beneath(0), diffuse(lobe) {}
    HD Lobe(const RoughDiffuseLobe& lobe) : kind(LobeKind::RoughDiffuse), beneath(0), rough_diffuse(lobe) {}
    HD Lobe(const MetalLobe& lobe) : kind(LobeKind::Metal), beneath(0), metal(lobe) {}
    HD Lobe(const ConductorLobe& lobe) : kind(LobeKind::Conductor), beneath(0), conductor(lobe) {}
    HD Lobe(const DielectricLobe& lobe) : kind(LobeKind::Dielectric), beneath(0), dielectric(lobe) {}
    HD Lobe(const SchlickLobe& lobe) : kind(LobeKind::Schlick), beneath(0), schlick(lobe) {}
    HD Lobe(const SpecularLobe& lobe) : kind(LobeKind::Specular), beneath(0), reflection(lobe) {}
    HD Lobe(const FilmedLobe& lobe) : kind(LobeKind::Filmed), beneath(0), filmed(lobe) {}
    HD Lobe(const RetroLobe& lobe) : kind(LobeKind::Retro), beneath(0), retro(lobe) {}
    HD Lobe(const FilmedRetroLobe& lobe) : kind(LobeKind::FilmedRetro), beneath(0), filmed_retro(lobe) {}
    HD Lobe(const ThinLobe& lobe) : kind(LobeKind::Thin), beneath(0), thin(lobe) {}
    HD Lobe(const TranslucentLobe& lobe) : kind(LobeKind::Translucent), beneath(0), translucent(lobe) {}
    HD Lobe(const GlassLobe& lobe) : kind(LobeKind::Glass), beneath(0), glass(lobe) {}
    HD Lobe(const CoatLobe& lobe) : kind(LobeKind::Coat), beneath(0), coat(lobe) {}
    HD Lobe(const SheenLobe& lobe) : kind(LobeKind::Sheen), beneath(0), sheen(lobe) {}
    HD Lobe(const FuzzLobe& lobe) : kind(LobeKind::Fuzz), beneath(0), fuzz(lobe) {}

    HD LobeClass lobe_class() const {
        switch (kind) {
        case LobeKind::None:
            break;
        case LobeKind::Diffuse:
            return diffuse.lobe_class();
        case LobeKind::RoughDiffuse:
            return rough_diffuse.lobe_class();
        case LobeKind::Conductor:
            return conductor.lobe_class();
        case LobeKind::Metal:
            return metal.unpacked().lobe_class();
        case LobeKind::Dielectric:
            return dielectric.lobe_class();
        case LobeKind::Schlick:
            return schlick.lobe_class();
        case LobeKind::Specular:
            return reflection.lobe_class();
        case LobeKind::Filmed:
            return filmed.unpacked().lobe_class();
        case LobeKind::Retro:
        case LobeKind::FilmedRetro:
            return LobeClass::Glossy;
        case LobeKind::Thin:
            return thin.lobe_class();
        case LobeKind::Translucent:
            return translucent.lobe_class();
        case LobeKind::Glass:
            return glass.unpacked().lobe_class();
        case LobeKind::Coat:
            return coat.lobe_class();
        case LobeKind::Sheen:
            return sheen.lobe_class();
        case LobeKind::Fuzz:
            return fuzz.lobe_class();
        }
        return LobeClass::Diffuse;
    }
    HD float energy() const {
        switch (kind) {
        case LobeKind::None:
            break;
        case LobeKind::Diffuse:
            return diffuse.energy();
        case LobeKind::RoughDiffuse:
            return rough_diffuse.energy();
        case LobeKind::Conductor:
            return conductor.energy();
        case LobeKind::Metal:
            return metal.unpacked().energy();
        case LobeKind::Dielectric:
            return dielectric.energy();
        case LobeKind::Schlick:
            return schlick.energy();
        case LobeKind::Specular:
            return reflection.energy();
        case LobeKind::Filmed:
            return filmed.unpacked().energy();
        case LobeKind::Retro:
            return retro.unpacked().energy();
        case LobeKind::FilmedRetro:
            return filmed_retro.unpacked().energy();
        case LobeKind::Thin:
            return thin.energy();
        case LobeKind::Translucent:
            return translucent.energy();
        case LobeKind::Glass:
            return glass.unpacked().energy();
        case LobeKind::Coat:
            return coat.energy();
        case LobeKind::Sheen:
            return sheen.energy();
        case LobeKind::Fuzz:
            return fuzz.energy();
        }
        return 0;
    }
    HD Gloss gloss(float cos_o) const {
        switch (kind) {
        case LobeKind::None:
        case LobeKind::Diffuse:
        case LobeKind::RoughDiffuse:
        case LobeKind::Translucent:
        case LobeKind::Sheen:
        case LobeKind::Fuzz:
            break;
        case LobeKind::Conductor:
            return conductor.gloss(cos_o);
        case LobeKind::Metal:
            return metal.unpacked().gloss(cos_o);
        case LobeKind::Dielectric:
            return dielectric.gloss(cos_o);
        case LobeKind::Schlick:
            return schlick.gloss(cos_o);
        case LobeKind::Specular:
            return reflection.gloss(cos_o);
        case LobeKind::Filmed:
            return filmed.unpacked().gloss(cos_o);
        case LobeKind::Retro:
            return retro.unpacked().gloss(cos_o);
        case LobeKind::FilmedRetro:
            return filmed_retro.unpacked().gloss(cos_o);
        case LobeKind::Thin:
            return thin.gloss(cos_o);
        case LobeKind::Glass:
            return glass.unpacked().gloss(cos_o);
        case LobeKind::Coat:
            return coat.gloss(cos_o);
        }
        return {};
    }
    HD SpecularBranches specular(Vec3 wo) const {
        switch (kind) {
        case LobeKind::None:
        case LobeKind::Diffuse:
        case LobeKind::RoughDiffuse:
        case LobeKind::Retro:
        case LobeKind::FilmedRetro:
        case LobeKind::Translucent:
        case LobeKind::Sheen:
        case LobeKind::Fuzz:
            break;
        case LobeKind::Conductor:
            return conductor.specular(wo);
        case LobeKind::Metal:
            return metal.unpacked().specular(wo);
        case LobeKind::Dielectric:
            return dielectric.specular(wo);
        case LobeKind::Schlick:
            return schlick.specular(wo);
        case LobeKind::Specular:
            return reflection.specular(wo);
        case LobeKind::Filmed:
            return filmed.unpacked().specular(wo);
        case LobeKind::Thin:
            return thin.specular(wo);
        case LobeKind::Glass:
            return glass.unpacked().specular(wo);
        case LobeKind::Coat:
            return coat.specular(wo);
        }
        return {};
    }
    /// Lets coats on the lobe return light to its metal.
    HD void describe_metal(LayerTransmittance& transmittance) const {
        float alpha = 0, share = 1;
        switch (kind) {
        case LobeKind::Conductor:
            alpha = conductor.alpha;
            break;
        case LobeKind::Metal:
            alpha = metal.microfacets.even_width();
            break;
        case LobeKind::Schlick:
            alpha = schlick.alpha;
            share = schlick.metallic;
            break;
        case LobeKind::Specular:
            alpha = reflection.alpha;
            share = reflection.metallic;
            break;
        case LobeKind::Filmed:
            alpha = filmed.surface.microfacets.even_width();
            share = filmed.color_b_metallic.high();
            break;
        default:
            break;
        }
        transmittance.metal_alpha = alpha;
        transmittance.metal_share = alpha >= kSmoothAlpha ? share : 0.0f;
    }
    /// Value and density that the lobe adds under `transmittance`; a layer then moves `transmittance` beneath itself.
    HD BsdfValue evaluate(Vec3 wo, Vec3 wi, LayerTransmittance& transmittance) const {
        switch (kind) {
        case LobeKind::None:
            break;
        case LobeKind::Diffuse:
            return diffuse.evaluate(wo, wi, transmittance);
        case LobeKind::RoughDiffuse:
            return rough_diffuse.evaluate(wo, wi, transmittance);
        case LobeKind::Conductor:
            return conductor.evaluate(wo, wi, transmittance);
        case LobeKind::Metal:
            return metal.unpacked().evaluate(wo, wi, transmittance);
        case LobeKind::Dielectric:
            return dielectric.evaluate(wo, wi, transmittance);
        case LobeKind::Schlick:
            return schlick.evaluate(wo, wi, beneath, transmittance);
        case LobeKind::Specular:
            return reflection.evaluate(wo, wi, beneath, transmittance);
        case LobeKind::Filmed:
            return filmed.unpacked().evaluate(wo, wi, beneath, transmittance);
        case LobeKind::Retro:
            return retro.unpacked().evaluate(wo, wi, beneath, transmittance);
        case LobeKind::FilmedRetro:
            return filmed_retro.unpacked().evaluate(wo, wi, beneath, transmittance);
        case LobeKind::Thin:
            return thin.evaluate(wo, wi, beneath, transmittance);
        case LobeKind::Translucent:
            return translucent.evaluate(wo, wi, beneath, transmittance);
        case LobeKind::Glass:
            return glass.unpacked().evaluate(wo, wi, beneath, transmittance);
        case LobeKind::Coat:
            return coat.evaluate(wo, wi, beneath, transmittance);
        case LobeKind::Sheen:
            return sheen.evaluate(wo, wi, beneath, transmittance);
        case LobeKind::Fuzz:
            return fuzz.evaluate(wo, wi, beneath, transmittance);
        }
        return {};
    }
    HD LobeDraw draw(Vec3 wo, float u_lobe, Vec2 u) const {
        switch (kind) {
        case LobeKind::None:
            break;
        case LobeKind::Diffuse:
            return diffuse.draw(wo, u);
        case LobeKind::RoughDiffuse:
            return rough_diffuse.draw(wo, u_lobe, u);
        case LobeKind::Conductor:
            return conductor.draw(wo, u_lobe, u);
        case LobeKind::Metal:
            return metal.unpacked().draw(wo, u_lobe, u);
        case LobeKind::Dielectric:
            return dielectric.draw(wo, u_lobe, u);
        case LobeKind::Schlick:
            return schlick.draw(wo, beneath, u_lobe, u);
        case LobeKind::Specular:
            return reflection.draw(wo, beneath, u_lobe, u);
        case LobeKind::Filmed:
            return filmed.unpacked().draw(wo, beneath, u_lobe, u);
        case LobeKind::Retro:
            return retro.unpacked().draw(wo, beneath, u_lobe, u);
        case LobeKind::FilmedRetro:
            return filmed_retro.unpacked().draw(wo, beneath, u_lobe, u);
        case LobeKind::Thin:
            return thin.draw(wo, beneath, u_lobe, u);
        case LobeKind::Translucent:
            return translucent.draw(wo, beneath, u_lobe, u);
        case LobeKind::Glass:
            return glass.unpacked().draw(wo, beneath, u_lobe, u);
        case LobeKind::Coat:
            return coat.draw(wo, beneath, u_lobe, u);
        case LobeKind::Sheen:
            return sheen.draw(wo, beneath, u_lobe, u);
        case LobeKind::Fuzz:
            return fuzz.draw(wo, beneath, u_lobe, u);
        }
        return {};
    }

    /// evaluate() and draw() of the bases that kernels inline, because no stack is needed for them.
    HD BsdfValue evaluate_inlined(Vec3 wo, Vec3 wi) const {
        if (kind == LobeKind::Diffuse) return diffuse.evaluate(wo, wi, {});
        if (kind == LobeKind::Conductor) return conductor.evaluate(wo, wi, {});
        return kind == LobeKind::Dielectric ? dielectric.evaluate(wo, wi, {}) : BsdfValue{};
    }
    HD LobeDraw draw_inlined(Vec3 wo, float u_lobe, Vec2 u) const {
        if (kind == LobeKind::Diffuse) return diffuse.draw(wo, u);
        if (kind == LobeKind::Conductor) return conductor.draw(wo, u_lobe, u);
        return kind == LobeKind::Dielectric ? dielectric.draw(wo, u_lobe, u) : LobeDraw{};
    }
};

} // namespace pertev
