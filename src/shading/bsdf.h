#pragma once

// A BSDF: a base with layers on it, each a lobe (lobes/layer_transmittance.h), as one plain struct without references.
// A new lobe needs a file in lobes/, what lobe.h says, a make function, and a line in tests/statistical/bsdf_cases.h.

#include "base/host_device.h"
#include "shading/lobe.h"

namespace pertev {

/// Says whether called functions of stacks get a copy of their BSDF. In kernels whose BSDFs are never stacks, the
/// address that such a call takes would keep all BSDFs in memory, though the call is never made; a copy does not.
/// Kernels for stacks have them in memory anyway, and there copies are most of what shading reads and writes.
enum class BsdfPass : uint8_t { Copied, InPlace };

struct Bsdf {
    static constexpr int kMaxLayers = 4; // thin wall or sheet, reflection or share of glass, sheen, coat

    Lobe base;
    int layer_count = 0;
    Lobe layers[kMaxLayers];      // the innermost first; a Schlick lobe is the innermost
    bool is_stacked = false;      // there are layers that may lie on anything
    bool has_far_light = false;   // a layer transmits light to the other side
    bool has_rough_layer = false; // a layer has no delta lobe alone
    // Functions of the lobes are called, not inlined (HD_CALL): those of stacks always are, and kernels for stacks call
    // those of any BSDF, because inlining both would double their code.
    bool is_called = false;

    Bsdf() = default;
    /// Makes a BSDF of one lobe, which is constructed in place, because a copy would wait for its own stores.
    HD explicit Bsdf(const DiffuseLobe& lobe) : base(lobe) {}

    HD explicit Bsdf(const RoughDiffuseLobe& lobe) : base(lobe), is_called(true) {}
    HD explicit Bsdf(const MetalLobe& lobe) : base(lobe), is_called(true) {}

    /// Adds the reflection on the base, the innermost layer.
    HD void add(const SchlickLobe& lobe) {
        layers[0] = lobe;
        layers[0].beneath = base.kind == LobeKind::Diffuse ? base.diffuse.energy() : 0.0f;
        layer_count = 1;
        has_rough_layer = !lobe.is_smooth();
    }
    /// Adds a layer on top. There is room for kMaxLayers; further ones are ignored.
    HD void add(const CoatLobe& lobe) { stack(lobe); }
    HD void add(const SheenLobe& lobe) { stack(lobe); }
    HD void add(const FuzzLobe& lobe) { stack(lobe); }
    HD void add(const SpecularLobe& lobe) { stack(lobe); }
    HD void add(const FilmedLobe& lobe) { stack(lobe); }
    HD void add(const RetroLobe& lobe) { stack(lobe); }
    HD void add(const FilmedRetroLobe& lobe) { stack(lobe); }
    HD void add(const ThinLobe& lobe) { stack_far(lobe); }
    HD void add(const TranslucentLobe& lobe) { stack_far(lobe); }
    HD void add(const GlassLobe& lobe) { stack_far(lobe); }

    /// Returns whether the BSDF is a single diffuse lobe, which most surfaces have and a fast path handles.
    HD bool is_diffuse() const { return base.kind == LobeKind::Diffuse && layer_count == 0; }

    /// Value of the lobes of `classes`, and density of all lobes.
    template <BsdfPass kPass = BsdfPass::Copied>
    HD BsdfValue evaluate(Vec3 wo, Vec3 wi, LobeClasses classes = kAllLobeClasses) const {
        if (is_diffuse()) return masked(LobeClass::Diffuse, base.diffuse.evaluate(wo, wi, {}), classes);
        return evaluate_lobes<kPass>(wo, wi, classes);
    }
    HD Rgb eval(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).f; }
    HD float pdf(Vec3 wo, Vec3 wi) const { return evaluate(wo, wi).pdf; }

    template <BsdfPass kPass = BsdfPass::Copied>
    HD BsdfSample sample(Vec3 wo, float u_lobe, Vec2 u) const {
        if (wo.z == 0) return {};
        if (is_diffuse()) {
            const Vec3 wi = base.diffuse.draw(wo, u).sample.wi;
            return make_bsdf_sample(wi, base.diffuse.evaluate(wo, wi, {}), LobeClass::Diffuse);
        }
        return sample_lobes<kPass>(wo, u_lobe, u);
    }

    /// Fraction of eval() that diffuse lobes contribute, [0, 1].
    HD Rgb diffuse_share(Vec3 wo, Vec3 wi) const {
        if (is_diffuse()) return {1, 1, 1};
        return is_called ? diffuse_share_of_lobes<true>(*this, wo, wi) : diffuse_share_of_lobes<false>(*this, wo, wi);
    }
    /// Returns whether sample() uses u_lobe.
    HD bool draws_lobe() const { return !is_diffuse() && (layer_count != 0 || base.kind != LobeKind::None); }

    /// Light from all delta lobes to wo: the expected values of what sample() draws of them.
    HD SpecularBranches specular(Vec3 wo) const {
        return is_diffuse() || wo.z == 0 ? SpecularBranches{} : specular_of_lobes(*this, wo);
    }
    /// Reflectance of the diffuse base, [0, 1], regardless of layers.
    HD Rgb diffuse_albedo() const {
        if (is_called && base.kind == LobeKind::RoughDiffuse) return base.rough_diffuse.average_albedo();
        return base.kind == LobeKind::Diffuse ? base.diffuse.share * base.diffuse.albedo : Rgb{0, 0, 0};
    }

    /// Gloss of all non-diffuse lobes, seen at `cos_o` >= 0.
    HD Gloss gloss(float cos_o) const { return is_diffuse() ? Gloss{} : gloss_of_lobes(*this, cos_o); }

    /// Returns whether any lobe has this class.
    HD bool has(LobeClass lobe_class) const {
        if (base.kind != LobeKind::None && base.lobe_class() == lobe_class) return true;
        for (int i = 0; i < layer_count; ++i)
            if (layers[i].lobe_class() == lobe_class) return true;
        return false;
    }
    /// Returns whether light may be transmitted from behind.
    HD bool lets_through() const { return base.kind == LobeKind::Dielectric || has_far_light; }
    /// Index of refraction inside over that outside, if light is refracted; else 1.
    HD float inner_ior() const {
        if (base.kind == LobeKind::Dielectric) return base.dielectric.ior;
        return is_stacked ? inner_ior_of_stack(*this) : 1.0f;
    }
    HD bool has_delta() const { return has(LobeClass::Specular); }
    /// Returns whether eval() is black for every pair of directions, so that light sampling is useless.
    HD bool has_delta_only() const {
        if (is_called && has_rough_layer) return false;
        if (!is_called && layer_count == 1 && !layers[0].schlick.is_smooth()) return false;
        return base.kind == LobeKind::None || base.lobe_class() == LobeClass::Specular;
    }

private:
    /// The base has number 0. Loops over all lobes contain the code of each kind once.
    HD const Lobe& lobe(int i) const { return i > 0 ? layers[i - 1] : base; }
    HD_CALL void stack(const Lobe& layer) {
        if (layer_count == kMaxLayers) return;
        float beneath = 0;
        for (int i = 0; i <= layer_count; ++i) beneath += lobe(i).energy();
        layers[layer_count] = layer;
        layers[layer_count++].beneath = min(beneath, 1.0f);
        has_rough_layer = has_rough_layer || layer.lobe_class() != LobeClass::Specular;
        is_stacked = is_called = true;
    }
    HD void stack_far(const Lobe& layer) {
        stack(layer);
        has_far_light = true;
    }
    HD_CALL static float inner_ior_of_stack(const Bsdf& bsdf) {
        for (int i = 0; i < bsdf.layer_count; ++i)
            if (bsdf.layers[i].kind == LobeKind::Glass) return bsdf.layers[i].glass.ior;
        return 1;
    }
    template <bool kIsCalled>
    HD_CALL static Rgb diffuse_share_of_lobes(Bsdf bsdf, Vec3 wo, Vec3 wi) {
#if defined(__CUDA_ARCH__)
        __builtin_assume(bsdf.is_called == kIsCalled);
#endif
        const Rgb all = bsdf.eval(wo, wi), f = bsdf.evaluate(wo, wi, only(LobeClass::Diffuse)).f;
        return {all.r > 0 ? min(f.r / all.r, 1.0f) : 0.0f, all.g > 0 ? min(f.g / all.g, 1.0f) : 0.0f,
                all.b > 0 ? min(f.b / all.b, 1.0f) : 0.0f};
    }
    HD_CALL static Gloss gloss_of_lobes(Bsdf bsdf, float cos_o) {
        Gloss gloss = bsdf.lobe(0).gloss(cos_o);
        for (int i = 1; i <= bsdf.layer_count; ++i) gloss = gloss + bsdf.lobe(i).gloss(cos_o);
        return gloss;
    }
    HD static BsdfValue masked(LobeClass lobe_class, BsdfValue value, LobeClasses classes) {
        if (!classes.has(lobe_class)) value.f = {};
        return value;
    }
    HD BsdfValue evaluate_diffuse(Vec3 wo, Vec3 wi, const LayerTransmittance& transmittance) const {
        return base.kind == LobeKind::Diffuse ? base.diffuse.evaluate(wo, wi, transmittance) : BsdfValue{};
    }
    template <BsdfPass kPass>
    HD BsdfValue evaluate_lobes(Vec3 wo, Vec3 wi, LobeClasses classes) const {
        if (is_called) {
            if constexpr (kPass == BsdfPass::InPlace) return evaluate_stack(*this, wo, wi, classes);
            return evaluate_copy(*this, wo, wi, classes);
        }
        LayerTransmittance transmittance;
        if (layer_count == 0) return masked(base.lobe_class(), base.evaluate_inlined(wo, wi), classes);
        const BsdfValue layer = layers[0].schlick.evaluate(wo, wi, layers[0].beneath, transmittance);
        const LobeClass layer_class = layers[0].schlick.lobe_class();
        return masked(layer_class, layer, classes) +
               masked(LobeClass::Diffuse, evaluate_diffuse(wo, wi, transmittance), classes);
    }
    template <BsdfPass kPass>
    HD BsdfSample sample_lobes(Vec3 wo, float u_lobe, Vec2 u) const {
        if (is_called) {
            if constexpr (kPass == BsdfPass::InPlace) return sample_stack(*this, wo, u_lobe, u);
            return sample_copy(*this, wo, u_lobe, u);
        }
        LobeDraw draw = {.u_lobe = u_lobe, .is_beneath = true};
        if (layer_count == 1) draw = layers[0].schlick.draw(wo, layers[0].beneath, u_lobe, u);
        const LobeClass lobe_class = draw.is_beneath ? base.lobe_class() : layers[0].schlick.lobe_class();
        if (draw.is_beneath) draw = base.draw_inlined(wo, draw.u_lobe, u);
        return finish<kPass>(draw, lobe_class, wo);
    }

    template <BsdfPass kPass>
    HD BsdfSample finish(const LobeDraw& draw, LobeClass lobe_class, Vec3 wo) const {
        if (!(draw.sample.pdf > 0)) return {};
        if (lobe_class != LobeClass::Specular) {
            return make_bsdf_sample(draw.sample.wi, evaluate_lobes<kPass>(wo, draw.sample.wi, kAllLobeClasses),
                                    lobe_class, draw.sample.is_transmission);
        }
        BsdfSample sample = draw.sample;
        sample.lobe_class = lobe_class;
        return sample;
    }

    /// Evaluates the lobes from the outermost to number `last`; `transmittance` then describes what is beneath them.
    HD BsdfValue evaluate_down_to(int last, Vec3 wo, Vec3 wi, LobeClasses classes,
                                  LayerTransmittance& transmittance) const {
        BsdfValue sum;
        for (int i = layer_count; i >= last; --i) {
            const Rgb tint = transmittance.tint;
            BsdfValue value = masked(lobe(i).lobe_class(), lobe(i).evaluate(wo, wi, transmittance), classes);
            value.f = tint * value.f;
            sum = sum + value;
        }
        return sum;
    }
    HD_CALL static BsdfValue evaluate_stack(const Bsdf& bsdf, Vec3 wo, Vec3 wi, LobeClasses classes) {
        LayerTransmittance transmittance;
        (bsdf.base.kind == LobeKind::Conductor || bsdf.base.kind == LobeKind::Metal ? bsdf.base : bsdf.layers[0])
            .describe_metal(transmittance);
        return bsdf.evaluate_down_to(0, wo, wi, classes, transmittance);
    }
    HD_CALL static BsdfValue evaluate_copy(Bsdf bsdf, Vec3 wo, Vec3 wi, LobeClasses classes) {
        return evaluate_stack(bsdf, wo, wi, classes);
    }
    HD_CALL static SpecularBranches specular_of_lobes(Bsdf bsdf, Vec3 wo) {
        SpecularBranches sum;
        for (int i = bsdf.layer_count; i >= 0; --i) {
            const SpecularBranches one = bsdf.lobe(i).specular(wo);
            sum.mirror += light_through(bsdf, i, wo, {-wo.x, -wo.y, wo.z}) * one.mirror;
            if (is_black(one.refraction)) continue;
            sum.refraction = light_through(bsdf, i, wo, one.refracted) * one.refraction;
            sum.refracted = one.refracted;
        }
        return sum;
    }
    /// Transmittance of the layers above lobe number `i` for light along wi to wo.
    HD static Rgb light_through(const Bsdf& bsdf, int i, Vec3 wo, Vec3 wi) {
        if (!bsdf.is_called) return {1, 1, 1};
        const LayerTransmittance above = above_in_stack(bsdf, i, wo, wi);
        return above.light_of_delta() * above.tint;
    }
    HD_CALL static LayerTransmittance above_in_stack(const Bsdf& bsdf, int i, Vec3 wo, Vec3 wi) {
        LayerTransmittance transmittance;
        bsdf.evaluate_down_to(i + 1, wo, wi, kAllLobeClasses, transmittance);
        return transmittance;
    }
    HD_CALL static BsdfSample sample_stack(const Bsdf& bsdf, Vec3 wo, float u_lobe, Vec2 u) {
        LobeDraw draw = {.u_lobe = u_lobe, .is_beneath = true};
        int i = bsdf.layer_count + 1;
        while (draw.is_beneath && i > 0) draw = bsdf.lobe(--i).draw(wo, draw.u_lobe, u);
#if defined(__CUDA_ARCH__)
        __builtin_assume(bsdf.is_called);
#endif
        BsdfSample sample = bsdf.finish<BsdfPass::InPlace>(draw, bsdf.lobe(i).lobe_class(), wo);
        if (!sample.is_delta()) return sample;
        const LayerTransmittance transmittance = above_in_stack(bsdf, i, wo, sample.wi);
        sample.weight = ((transmittance.light_of_delta() / transmittance.reach) * sample.weight) * transmittance.tint;
        sample.pdf = transmittance.reach * sample.pdf;
        return sample;
    }
    HD_CALL static BsdfSample sample_copy(Bsdf bsdf, Vec3 wo, float u_lobe, Vec2 u) {
        return sample_stack(bsdf, wo, u_lobe, u);
    }
};

/// Converts a material's perceptual roughness, [0, 1], to a GGX width.
HD inline float alpha_from_roughness(float roughness) { return square(clamp(roughness, 0.0f, 1.0f)); }

/// Makes a diffuse BSDF with `albedo` in [0, 1].
HD inline Bsdf make_diffuse(Rgb albedo) { return Bsdf(DiffuseLobe{albedo, 1}); }
/// Makes a conductor with the complex index eta + i k, both >= 0; roughness in [0, 1].
HD inline Bsdf make_conductor(Rgb eta, Rgb k, float roughness) {
    Bsdf bsdf;
    bsdf.base = ConductorLobe{eta, k, alpha_from_roughness(roughness)};
    return bsdf;
}
/// Makes a dielectric. `ior` > 0 is the index inside over that outside; for a rough surface it is clamped to [1.1, 3]
/// (or its inverse). `tint` is in [0, 1].
HD inline Bsdf make_dielectric(float ior, float roughness, Rgb tint) {
    const float alpha = alpha_from_roughness(roughness);
    Bsdf bsdf;
    bsdf.base = DielectricLobe{tint, alpha, DielectricLobe::usable_ior(ior, alpha)};
    return bsdf;
}
/// Makes glTF's metallic-roughness BSDF: `base_color`, `metallic` and `roughness` in [0, 1]; `ior` > 0 is that of the
/// coat.
HD inline Bsdf make_metallic_roughness(Rgb base_color, float metallic, float roughness, float ior) {
    const float metal = clamp(metallic, 0.0f, 1.0f);
    Bsdf bsdf;
    if (metal < 1 && !is_black(base_color)) bsdf.base = DiffuseLobe{base_color, 1.0f - metal};
    bsdf.add(SchlickLobe{base_color, metal, alpha_from_roughness(roughness), f0_from_ior(ior)});
    return bsdf;
}

/// Adds a clear coat to `bsdf`, which has at most kMaxLayers - 1 layers: `strength` and `roughness` in [0, 1], `ior`
/// >= 1 (1.5 in KHR_materials_clearcoat), `normal` unit with z > 0 in the frame of `bsdf`, `color` in [0, 1]: the share
/// of light that both ways through the coat leave at normal incidence.
HD inline void add_coat(Bsdf& bsdf, float strength, float roughness, float ior, Vec3 normal, Rgb color,
                        Stretch stretch = {}) {
    CoatLobe coat = {strength, alpha_from_roughness(roughness), f0_from_ior(ior), normal};
    coat.set_stretch(stretch);
    if (!(color == Rgb{1, 1, 1})) {
        coat.color_rg = UnitPair(color.r, color.g);
        coat.color_b_and_solid = UnitPair(color.b, bsdf.inner_ior() != 1 ? 1.0f : 0.0f);
    }
    bsdf.add(coat);
}
/// Adds sheen (KHR_materials_sheen) to `bsdf`, which has at most kMaxLayers - 1 layers: `color` and `roughness` in
/// [0, 1].
HD inline void add_sheen(Bsdf& bsdf, Rgb color, float roughness) {
    bsdf.add(SheenLobe{color, SheenLobe::usable_alpha(roughness)});
}
/// Adds OpenPBR's fuzz to `bsdf`, as add_sheen.
HD inline void add_fuzz(Bsdf& bsdf, Rgb color, float roughness) {
    bsdf.add(FuzzLobe{color, FuzzLobe::usable_roughness(roughness)});
}

/// Returns copies of `bsdf` with a layer of these functions.
HD inline Bsdf make_coated(Bsdf bsdf, float strength, float roughness, float ior, Vec3 normal = {0, 0, 1},
                           Rgb color = {1, 1, 1}, Stretch stretch = {}) {
    add_coat(bsdf, strength, roughness, ior, normal, color, stretch);
    return bsdf;
}
HD inline Bsdf make_sheen(Bsdf bsdf, Rgb color, float roughness) {
    add_sheen(bsdf, color, roughness);
    return bsdf;
}
HD inline Bsdf make_fuzz(Bsdf bsdf, Rgb color, float roughness) {
    add_fuzz(bsdf, color, roughness);
    return bsdf;
}

} // namespace pertev
