#pragma once

// The BSDFs of the statistical tests, and functions that the tests share.

#include <cmath>
#include <string>
#include <vector>

#include "math/random.h"
#include "math/sampler.h"
#include "shading/make_reflection.h"

namespace pertev::test {

struct BsdfCase {
    std::string name;
    Bsdf bsdf;
};

inline constexpr Rgb kGoldEta = {0.2f, 0.92f, 1.1f}, kGoldK = {3.9f, 2.45f, 2.14f};

/// the GGX width of the narrowest lobe that is not delta; 1 without such a lobe
inline float narrowest_alpha(const Bsdf& bsdf) {
    float least = 1;
    const auto add = [&](float alpha) { least = alpha < kSmoothAlpha ? least : std::fmin(least, alpha); };
    if (bsdf.base.kind == LobeKind::Conductor) add(bsdf.base.conductor.alpha);
    if (bsdf.base.kind == LobeKind::Dielectric) add(bsdf.base.dielectric.alpha);
    if (bsdf.base.kind == LobeKind::Metal) add(bsdf.base.metal.unpacked().widths.narrowest());
    for (int i = 0; i < bsdf.layer_count; ++i) {
        if (bsdf.layers[i].kind == LobeKind::Schlick) add(bsdf.layers[i].schlick.alpha);
        if (bsdf.layers[i].kind == LobeKind::Coat) add(bsdf.layers[i].coat.alpha);
        if (bsdf.layers[i].kind == LobeKind::Specular) add(bsdf.layers[i].reflection.alpha);
        if (bsdf.layers[i].kind == LobeKind::Thin) add(bsdf.layers[i].thin.widths.narrowest());
        if (bsdf.layers[i].kind == LobeKind::Retro) add(bsdf.layers[i].retro.alpha);
        if (bsdf.layers[i].kind == LobeKind::FilmedRetro)
            add(bsdf.layers[i].filmed_retro.unpacked().lobe.widths.narrowest());
        if (bsdf.layers[i].kind == LobeKind::Filmed) add(bsdf.layers[i].filmed.unpacked().widths.narrowest());
        if (bsdf.layers[i].kind == LobeKind::Glass) add(bsdf.layers[i].glass.unpacked().widths.narrowest());
    }
    return least;
}

/// Returns each channel's index inside over that outside; they differ in dispersed glass alone.
inline Rgb inner_iors(const Bsdf& bsdf) {
    for (int i = 0; i < bsdf.layer_count; ++i) {
        if (bsdf.layers[i].kind != LobeKind::Glass) continue;
        const GlassLobe glass = bsdf.layers[i].glass.unpacked();
        return {glass.of_channel(0).ior, glass.of_channel(1).ior, glass.of_channel(2).ior};
    }
    return grey(bsdf.inner_ior());
}

/// Returns lobes with parameters of OpenPBR that glTF does not have, and those that other renderers' files name.
inline std::vector<BsdfCase> openpbr_bsdf_cases() {
    const auto metal = [](float roughness, ReflectionParameters p) {
        p.roughness = roughness;
        return make_metal(kGoldEta, kGoldK, p);
    };
    return {
        {"slightly rough diffuse", make_rough_diffuse({0.8f, 0.5f, 0.2f}, 0.1f)},
        {"rough diffuse", make_rough_diffuse({0.8f, 0.5f, 0.2f}, 0.5f)},
        {"white, entirely rough diffuse", make_rough_diffuse(grey(1), 1)},
        {"plastic on rough diffuse", make_reflection({.base_color = {0.8f, 0.5f, 0.2f},
                                                      .roughness = 0.4f,
                                                      .through = 0.2f,
                                                      .translucent = 0.3f,
                                                      .translucent_color = {0.5f, 0.9f, 0.2f},
                                                      .diffuse_roughness = 0.8f})},
        {"velvet on rough diffuse", make_sheen(make_rough_diffuse({0.8f, 0.2f, 0.3f}, 1), {0.6f, 0.7f, 1.0f}, 0.5f)},
        {"fuzz alone", make_fuzz(Bsdf{}, {1.0f, 0.7f, 0.4f}, 0.35f)},
        {"rough fuzz on a frosted pane",
         make_fuzz(make_reflection({.base_color = {0.9f, 0.6f, 0.2f}, .roughness = 0.6f, .through = 0.6f}),
                   {0.4f, 0.5f, 0.8f}, 0.9f)},
        {"tinted varnish on fuzz on rough diffuse",
         make_coated(make_fuzz(make_rough_diffuse({0.8f, 0.2f, 0.3f}, 1), {0.6f, 0.7f, 1.0f}, 0.5f), 0.8f, 0.4f, 1.6f,
                     {0, 0, 1}, {0.9f, 0.4f, 0.1f})},
        {"tinted, bent varnish on gold", make_coated(make_conductor(kGoldEta, kGoldK, 0.5f), 1, 0.3f, 1.5f,
                                                     normalize(Vec3{0.2f, 0.1f, 1}), {0.2f, 0.9f, 0.6f})},
        {"tinted varnish on glass",
         make_coated(make_dielectric(1.5f, 0.5f, grey(1)), 0.7f, 0.6f, 1.5f, {0, 0, 1}, {0.2f, 0.9f, 0.6f})},
        {"brushed varnish on plastic", make_coated(make_metallic_roughness({0.2f, 0.5f, 0.8f}, 0, 0.6f, 1.5f), 1, 0.35f,
                                                   1.5f, {0, 0, 1}, grey(1), {{0.6f, 0.8f}, 0.7f})},
        {"brushed, tinted, bent varnish on rough gold",
         make_coated(make_conductor(kGoldEta, kGoldK, 0.5f), 0.7f, 0.4f, 1.8f, normalize(Vec3{0.2f, 0.1f, 1}),
                     {0.2f, 0.9f, 0.6f}, {{-0.8f, 0.6f}, 0.5f})},
        {"brushed frosted pane", make_reflection({.base_color = {0.9f, 0.6f, 0.2f},
                                                  .roughness = 0.5f,
                                                  .through = 0.7f,
                                                  .anisotropy = 0.6f,
                                                  .along = {0.6f, 0.8f}})},
        {"frosted pane of Beckmann and one bounce", make_reflection({.base_color = {0.9f, 0.6f, 0.2f},
                                                                     .roughness = 0.6f,
                                                                     .through = 1,
                                                                     .is_beckmann = true,
                                                                     .is_single = true})},
        {"brushed metal of Beckmann that sends half of the light back",
         make_reflection({.base_color = {0.9f, 0.5f, 0.1f},
                          .metallic = 0.5f,
                          .roughness = 0.5f,
                          .anisotropy = 0.6f,
                          .along = {0.6f, -0.8f},
                          .metal_tint = {0.2f, 0.6f, 1},
                          .retroreflectivity = 0.5f,
                          .is_beckmann = true})},
        {"F82 metal",
         make_reflection(
             {.base_color = {0.9f, 0.5f, 0.1f}, .metallic = 1, .roughness = 0.4f, .metal_tint = {0.2f, 0.6f, 1}})},
        {"half an F82 metal",
         make_reflection(
             {.base_color = {0.9f, 0.5f, 0.1f}, .metallic = 0.5f, .roughness = 0.5f, .metal_tint = {0.2f, 0.6f, 1}})},
        {"a sign of glass beads",
         make_reflection({.base_color = {0.2f, 0.5f, 0.8f}, .roughness = 0.4f, .retroreflectivity = 1})},
        {"half a metal that sends half of the light back, with panes",
         make_reflection({.base_color = {0.9f, 0.5f, 0.1f},
                          .metallic = 0.5f,
                          .roughness = 0.6f,
                          .color = {1, 0.5f, 2},
                          .through = 0.3f,
                          .retroreflectivity = 0.5f})},
        {"a varnished mirror that sends light back",
         make_coated(
             make_reflection(
                 {.base_color = {0.9f, 0.5f, 0.1f}, .metallic = 1, .roughness = 0.2f, .retroreflectivity = 0.75f}),
             0.5f, 0.3f, 1.5f)},
        {"gold of Beckmann and roughness 0.3", metal(0.3f, {.base_color = {}, .is_beckmann = true})},
        {"gold of Beckmann and roughness 1", metal(1, {.base_color = {}, .is_beckmann = true})},
        {"gold of GGX and one bounce", metal(0.6f, {.base_color = {}, .is_single = true})},
        {"brushed gold of Beckmann and one bounce",
         metal(0.5f,
               {.base_color = {}, .anisotropy = 0.7f, .along = {0.6f, 0.8f}, .is_beckmann = true, .is_single = true})},
        {"varnished gold of Beckmann",
         make_coated(metal(0.5f, {.base_color = {}, .is_beckmann = true}), 0.5f, 0.3f, 1.8f)},
        {"plastic of Beckmann",
         make_reflection({.base_color = {0.2f, 0.5f, 0.8f}, .roughness = 0.5f, .is_beckmann = true})},
        {"plastic of one bounce",
         make_reflection({.base_color = {0.2f, 0.5f, 0.8f}, .roughness = 0.6f, .is_single = true})},
        {"glass of Beckmann",
         make_reflection({.base_color = {1.0f, 0.9f, 0.7f}, .roughness = 0.5f, .solid = 1, .is_beckmann = true})},
        {"glass of one bounce",
         make_reflection({.base_color = {1.0f, 0.9f, 0.7f}, .roughness = 0.6f, .solid = 1, .is_single = true})},
        {"dispersed glass",
         make_reflection({.base_color = {1.0f, 0.9f, 0.7f}, .roughness = 0.5f, .solid = 1, .dispersion = 0.2f})},
        {"fuzz on varnish on dispersed, filmed glass",
         make_fuzz(make_coated(make_reflection({.base_color = {1.0f, 0.9f, 0.7f},
                                                .roughness = 0.6f,
                                                .solid = 1,
                                                .film = {.weight = 0.8f, .ior = 1.8f, .thickness = 0.4f},
                                                .dispersion = 0.3f}),
                               0.5f, 0.4f, 1.5f),
                   {0.4f, 0.5f, 0.8f}, 0.6f)}};
}

/// Returns layers on each other and on every base.
inline std::vector<BsdfCase> layered_bsdf_cases() {
    const Bsdf plastic = make_metallic_roughness({0.2f, 0.5f, 0.8f}, 0, 0.6f, 1.5f);
    const Bsdf half_metal = make_metallic_roughness({0.9f, 0.5f, 0.1f}, 0.5f, 0.4f, 1.5f);
    const Bsdf gold = make_conductor(kGoldEta, kGoldK, 0.4f), glass = make_dielectric(1.5f, 0.5f, {1.0f, 0.9f, 0.7f});
    return {{"varnished plastic", make_coated(plastic, 1, 0.35f, 1.5f)},
            {"half varnished gold", make_coated(gold, 0.5f, 0.3f, 1.8f)},
            {"varnished glass", make_coated(glass, 1, 0.6f, 1.5f)},
            {"half metal under a mirror of varnish", make_coated(half_metal, 0.8f, 0, 1.5f)},
            {"velvet", make_sheen(make_diffuse({0.8f, 0.2f, 0.3f}), {0.6f, 0.7f, 1.0f}, 0.5f)},
            {"coloured reflection", make_reflection({.base_color = {0.2f, 0.5f, 0.8f},
                                                     .metallic = 0.3f,
                                                     .roughness = 0.4f,
                                                     .weight = 0.8f,
                                                     .color = {9, 3, 0.5f}})},
            {"reflection at grazing angles alone",
             make_reflection({.base_color = {0.3f, 0.2f, 0.1f}, .roughness = 0.5f, .color = {0, 0, 0}})},
            {"frosted pane", make_reflection({.base_color = {0.9f, 0.6f, 0.2f}, .roughness = 0.6f, .through = 1})},
            {"varnished velvet on a half transparent pane",
             make_coated(make_sheen(make_reflection({.base_color = {0.9f, 0.6f, 0.2f},
                                                     .metallic = 0.1f,
                                                     .roughness = 0.7f,
                                                     .weight = 0.6f,
                                                     .color = {1, 0.5f, 2},
                                                     .through = 0.4f}),
                                    {0.2f, 0.1f, 0.3f}, 0.4f),
                         0.5f, 0.6f, 1.6f)},
            {"brushed metal of 30 degrees", make_reflection({.base_color = {0.9f, 0.6f, 0.2f},
                                                             .metallic = 0.8f,
                                                             .roughness = 0.5f,
                                                             .anisotropy = 0.7f,
                                                             .along = {0.8660254f, 0.5f}})},
            {"film on brushed plastic", make_reflection({.base_color = {0.3f, 0.6f, 0.5f},
                                                         .roughness = 0.5f,
                                                         .anisotropy = 0.5f,
                                                         .along = {0.6f, -0.8f},
                                                         .film = {.weight = 0.9f, .ior = 1.8f, .thickness = 0.45f}})},
            {"film on half a metal", make_reflection({.base_color = {0.9f, 0.5f, 0.1f},
                                                      .metallic = 0.5f,
                                                      .roughness = 0.4f,
                                                      .film = {.weight = 1, .ior = 1.33f, .thickness = 0.55f}})},
            {"a third of glass in half a metal",
             make_reflection(
                 {.base_color = {0.9f, 0.6f, 0.2f}, .metallic = 0.4f, .roughness = 0.5f, .ior = 1.4f, .solid = 0.5f})},
            {"brushed glass", make_reflection({.base_color = {1.0f, 0.9f, 0.7f},
                                               .roughness = 0.5f,
                                               .solid = 1,
                                               .anisotropy = 0.5f,
                                               .along = {0.6f, 0.8f}})},
            {"film on glass", make_coated(make_reflection({.base_color = {1.0f, 0.9f, 0.7f},
                                                           .roughness = 0.5f,
                                                           .solid = 1,
                                                           .film = {.weight = 1, .ior = 1.8f, .thickness = 0.4f}}),
                                          0.5f, 0.5f, 1.5f)},
            {"varnished leaf", make_coated(make_reflection({.base_color = {0.3f, 0.6f, 0.2f},
                                                            .roughness = 0.6f,
                                                            .through = 0.2f,
                                                            .translucent = 0.5f,
                                                            .translucent_color = {0.5f, 0.9f, 0.2f}}),
                                           1, 0.5f, 1.5f)},
            {"sheen alone", make_sheen(Bsdf{}, {1.0f, 0.7f, 0.4f}, 0.35f)},
            {"dust on varnished half metal",
             make_sheen(make_coated(half_metal, 0.5f, 0.3f, 1.5f), {0.5f, 0.4f, 0.3f}, 0.3f)}};
}

/// Returns each kind at several roughnesses, and layers. All but one have no delta lobes.
inline std::vector<BsdfCase> rough_bsdf_cases() {
    std::vector<BsdfCase> cases = {{"diffuse", make_diffuse({0.8f, 0.5f, 0.2f})}};
    for (const float r : {0.1f, 0.3f, 0.6f, 1.0f}) {
        const std::string at = " of roughness " + std::to_string(r);
        cases.push_back({"gold" + at, make_conductor(kGoldEta, kGoldK, r)});
        cases.push_back({"glass" + at, make_dielectric(1.5f, r, {1.0f, 0.9f, 0.7f})});
        cases.push_back({"plastic" + at, make_metallic_roughness({0.2f, 0.5f, 0.8f}, 0, r, 1.5f)});
    }
    cases.push_back({"half a metal", make_metallic_roughness({0.9f, 0.5f, 0.1f}, 0.5f, 0.4f, 1.5f)});
    cases.push_back({"glTF metal", make_metallic_roughness({0.9f, 0.5f, 0.1f}, 1, 0.5f, 1.5f)});
    cases.push_back({"mirror coat", make_metallic_roughness({0.2f, 0.5f, 0.8f}, 0, 0, 1.5f)});
    cases.push_back({"glass of index 1.1", make_dielectric(1.1f, 0.5f, grey(1))});
    cases.push_back({"glass of index 2.4", make_dielectric(2.4f, 0.35f, grey(1))});
    for (const BsdfCase& c : layered_bsdf_cases()) cases.push_back(c);
    for (const BsdfCase& c : openpbr_bsdf_cases()) cases.push_back(c);
    return cases;
}

/// Returns the unit vector with height `z` in [-1, 1] and azimuth `turns`, in full turns about the normal.
inline Vec3 direction_at(float z, float turns = 0.1f) {
    const float across = std::sqrt((1.0f - z) * (1.0f + z)), angle = 6.2831853f * turns;
    return {across * std::cos(angle), across * std::sin(angle), z};
}

struct SamplePoint {
    float lobe;
    Vec2 u;
};

/// Returns independent points for index and seed.
inline SamplePoint random_point(uint32_t i, uint32_t seed) {
    const Hash4 h = hash_words(i, seed, 0x9e3779b9u, i ^ seed);
    return {unit_interval(h.x), {unit_interval(h.y), unit_interval(h.z)}};
}

/// Returns point i of the Hammersley set of `count` points. The error of means over it is little more than 1 / count.
inline SamplePoint even_point(uint32_t i, uint32_t count) {
    double thirds = 0, digit = 1.0 / 3;
    for (uint32_t rest = i; rest != 0; rest /= 3, digit /= 3) thirds += digit * (rest % 3);
    const double lobe = (i + 0.5) / count;
    return {static_cast<float>(lobe) * 0x1.fffffep-1f,
            {static_cast<float>(thirds) * 0x1.fffffep-1f, unit_interval(reverse_bits(i))}};
}

struct MeanWeight {
    double r = 0, g = 0, b = 0;
    double largest() const { return std::fmax(r, std::fmax(g, b)); }
    double least() const { return std::fmin(r, std::fmin(g, b)); }
};

/// Returns the mean weight of sample() over `count` even points. It is the light that a furnace of radiance 1 sends to
/// wo.
inline MeanWeight mean_weight(const Bsdf& bsdf, Vec3 wo, uint32_t count) {
    MeanWeight mean;
    for (uint32_t i = 0; i < count; i++) {
        const SamplePoint p = even_point(i, count);
        const BsdfSample s = bsdf.sample(wo, p.lobe, p.u);
        if (!(s.pdf > 0)) continue;
        mean.r += static_cast<double>(s.weight.r);
        mean.g += static_cast<double>(s.weight.g);
        mean.b += static_cast<double>(s.weight.b);
    }
    const double scale = 1.0 / count;
    return {scale * mean.r, scale * mean.g, scale * mean.b};
}

} // namespace pertev::test
