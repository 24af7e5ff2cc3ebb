// The number of layers on a BSDF. tests/statistical/bsdf_sampling_test.cpp tests their reflection.

#include "shading/may_be_specular.h"

#include <doctest/doctest.h>

using namespace pertev;

TEST_CASE("a layer beyond the capacity is left out") {
    Bsdf bsdf{DiffuseLobe{{0.5f, 0.4f, 0.3f}, 1}};
    for (int i = 0; i < Bsdf::kMaxLayers; ++i) bsdf = make_coated(bsdf, 0.5f, 0.3f, 1.5f);
    const Bsdf full = bsdf;
    const Bsdf more[] = {make_coated(full, 1, 0.1f, 2), make_sheen(full, {1, 1, 1}, 0.5f)};
    const Vec3 wo = normalize(Vec3{0.3f, 0.1f, 0.9f}), wi = normalize(Vec3{-0.5f, 0.2f, 0.7f});
    for (const Bsdf& one_more : more) {
        CHECK(one_more.layer_count == Bsdf::kMaxLayers);
        CHECK(one_more.is_stacked);
        CHECK(one_more.pdf(wo, wi) == full.pdf(wo, wi));
        CHECK(one_more.eval(wo, wi).r == full.eval(wo, wi).r);
    }
    CHECK(full.eval(wo, wi).r !=
          make_coated(Bsdf{DiffuseLobe{{0.5f, 0.4f, 0.3f}, 1}}, 0.5f, 0.3f, 1.5f).eval(wo, wi).r);
}

TEST_CASE("materials with layers need the general variant, and smooth coats and panes may be mirrors") {
    MaterialParameters plastic = {.kind = MaterialKind::MetallicRoughness, .roughness = 0.5f};
    const auto variant = [](const MaterialParameters& material) { return variant_of({&material, 1}); };
    CHECK(variant(plastic) == ShadingVariant::Unstacked);
    CHECK(!may_be_specular(plastic));
    MaterialParameters coated = plastic, pane = plastic, velvet = {.kind = MaterialKind::Diffuse}, unlit = velvet;
    coated.coat_weight = 0.5f;
    coated.coat_roughness = 0.5f;
    CHECK(variant(coated) == ShadingVariant::General);
    CHECK(!may_be_specular(coated));
    coated.coat_roughness = 0;
    CHECK(may_be_specular(coated));
    pane.transmission_weight = 0.5f;
    CHECK(variant(pane) == ShadingVariant::General);
    CHECK(!may_be_specular(pane));
    pane.ior = 1; // a solid of index 1 is no interface
    CHECK(may_be_specular(pane));
    velvet.fuzz_weight = 1;
    CHECK(variant(velvet) == ShadingVariant::General);
    CHECK(!may_be_specular(velvet));
    unlit.kind = MaterialKind::Unlit;
    unlit.coat_weight = 1;
    CHECK(variant(unlit) == ShadingVariant::Unstacked);
    CHECK(!may_be_specular(unlit));
}
