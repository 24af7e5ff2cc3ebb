// KHR_materials_pbrSpecularGlossiness becomes a dielectric that reflects its specular colour.

#include <cmath>

#include <doctest/doctest.h>

#include "formats/gltf/specular_glossiness.h"
#include "shading/make_reflection.h"
#include "tests/support/gltf_builder.h"

using namespace pertev;

namespace specular_glossiness_test { // test files are compiled together

Material material_of(const std::string& members, Messages& messages, Scene* scene = nullptr) {
    test::GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    Scene read = test::read_gltf_text(
        builder.json(
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],"nodes":[{"mesh":0}],)"
            R"("textures":[{"source":0}],"images":[{"uri":"data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAAB)"
            R"(CAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC"}],"materials":[{"extensions":)"
            R"({"KHR_materials_pbrSpecularGlossiness":{)" +
            members + "}}}]"),
        messages);
    if (scene != nullptr) *scene = read;
    return read.materials.at(0);
}

TEST_CASE("a grey and low specular colour becomes an index of refraction") {
    Material to;
    gltf::set_specular_glossiness({{0.5f, 0.25f, 0}, {0.04f, 0.04f, 0.04f}, 0.75f}, false, to);
    CHECK(to.base_color == Rgb{0.5f, 0.25f, 0});
    CHECK(to.metallic == 0);
    CHECK(to.roughness == 0.25f);
    CHECK(to.ior == doctest::Approx(1.5).epsilon(1e-6));
    CHECK_FALSE(to.is_stacked());
}

TEST_CASE("any other specular colour is the reflectance at normal incidence, and 1 at grazing incidence") {
    for (const Rgb specular : {Rgb{1, 0.766f, 0.336f}, Rgb{0.5f, 0.5f, 0.5f}, Rgb{0, 0.1f, 0.03f}}) {
        Material to;
        gltf::set_specular_glossiness({{0.5f, 0, 0.5f}, specular, 1}, false, to);
        CHECK(to.kind == MaterialKind::MetallicRoughness);
        CHECK(to.roughness == 0);
        CHECK(to.metallic == 0);
        CHECK(to.base_color == Rgb{0.5f, 0, 0.5f});
        const Bsdf bsdf = make_reflection({.base_color = to.base_color,
                                           .roughness = 0,
                                           .ior = to.ior,
                                           .weight = to.specular_weight,
                                           .color = to.specular_color});
        // With a mirror's lobe, the chance of a sample times its weight is the reflectance.
        const auto reflectance = [&](Vec3 wo) {
            Rgb sum = {};
            constexpr int kDraws = 4096;
            for (int i = 0; i < kDraws; ++i) {
                const BsdfSample sample = bsdf.sample(wo, (static_cast<float>(i) + 0.5f) / kDraws, {0.3f, 0.6f});
                if (sample.is_delta()) sum += (1.0f / kDraws) * sample.weight;
            }
            return sum;
        };
        const Rgb normal = reflectance({0, 0, 1}), grazing = reflectance(normalize(Vec3{1, 0, 0.001f}));
        for (int c = 0; c < 3; ++c) {
            const auto of = [&](Rgb color) { return c == 0 ? color.r : c == 1 ? color.g : color.b; };
            CHECK(of(normal) == doctest::Approx(of(specular)).epsilon(0.01).scale(0.1));
            CHECK(of(grazing) == doctest::Approx(1).epsilon(0.02));
        }
    }
}

TEST_CASE("without a specular colour only the diffuse texture is visible") {
    Messages messages;
    const Material material = material_of(
        R"("diffuseTexture":{"index":0},"diffuseFactor":[1,0.5,1,0.25],"specularFactor":[0,0,0],"glossinessFactor":0)",
        messages);
    CHECK(material.kind == MaterialKind::Diffuse);
    CHECK(material.base_color == Rgb{1, 0.5f, 1});
    CHECK(material.alpha == 0.25f);
    CHECK(material.base_color_texture.has_image());
    CHECK(material.base_color_texture.is_srgb);
    CHECK(messages.left_out().empty());
}

TEST_CASE("a specular-glossiness texture is one of the specular colour and, by its opposite alpha, of roughness") {
    Messages messages;
    Scene scene;
    // The texel is red: a specular colour of (1, 0, 0), and glossy by its alpha of 1.
    const Material material = material_of(R"("specularGlossinessTexture":{"index":0},"diffuseFactor":[0,0.5,0,1],)"
                                          R"("specularFactor":[0.5,1,1],"glossinessFactor":0.75)",
                                          messages, &scene);
    REQUIRE(scene.images.size() == 2);
    CHECK(material.kind == MaterialKind::MetallicRoughness);
    CHECK(material.base_color == Rgb{0, 0.5f, 0});
    CHECK(material.roughness == 1);
    CHECK(material.metallic == 0);
    CHECK_FALSE(material.base_color_texture.has_image());
    CHECK(material.specular_color_texture.image == 0);
    CHECK(material.specular_color_texture.is_srgb);
    CHECK(material.specular_color.r == doctest::Approx(0.5 / 0.04));
    CHECK(material.roughness_texture.image == 1);
    CHECK_FALSE(material.roughness_texture.is_srgb);
    CHECK(scene.images[1].rgba8.pixels[material.roughness_texture.channel] == 64);
    CHECK(messages.left_out().empty());
}

} // namespace specular_glossiness_test
