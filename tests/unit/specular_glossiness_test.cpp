// KHR_materials_pbrSpecularGlossiness becomes metal and roughness.

#include <cmath>

#include <doctest/doctest.h>

#include "formats/gltf/specular_glossiness.h"
#include "image/srgb.h"
#include "tests/support/gltf_builder.h"

using namespace pertev;
using gltf::SpecularGlossiness;

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

TEST_CASE("a grey and low specular colour becomes an index of refraction without loss") {
    bool is_exact = false;
    const auto to = gltf::metallic_roughness_of({{0.5f, 0.25f, 0}, {0.04f, 0.04f, 0.04f}, 0.75f}, is_exact);
    CHECK(is_exact);
    CHECK(to.base_color == Rgb{0.5f, 0.25f, 0});
    CHECK(to.metallic == 0);
    CHECK(to.roughness == 0.25f);
    CHECK(to.ior == doctest::Approx(1.5).epsilon(1e-6));
}

TEST_CASE("a strong specular colour without a diffuse one becomes metal of that colour") {
    bool is_exact = true;
    const auto gold = gltf::metallic_roughness_of({{0, 0, 0}, {1, 0.766f, 0.336f}, 1}, is_exact);
    CHECK(!is_exact);
    CHECK(gold.metallic == doctest::Approx(1).epsilon(1e-3));
    CHECK(gold.base_color.r == doctest::Approx(1).epsilon(1e-3));
    CHECK(gold.base_color.g == doctest::Approx(0.766).epsilon(1e-3));
    CHECK(gold.base_color.b == doctest::Approx(0.336).epsilon(1e-3));
    CHECK(gold.roughness == 0);
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

TEST_CASE("a specular-glossiness texture is converted texel by texel, and losses are reported") {
    Messages messages;
    Scene scene;
    // The texel is red: a specular colour of (1, 0, 0), and glossy by its alpha of 1.
    const Material material =
        material_of(R"("specularGlossinessTexture":{"index":0},"diffuseFactor":[0,0,0,1],"glossinessFactor":0.75)",
                    messages, &scene);
    REQUIRE(scene.images.size() == 3);
    CHECK(material.kind == MaterialKind::MetallicRoughness);
    CHECK(material.base_color == Rgb{1, 1, 1});
    CHECK(material.roughness == 1);
    CHECK(material.metallic == 1);
    CHECK(material.base_color_texture.image == 1);
    CHECK(material.roughness_texture.image == 2);
    CHECK(material.roughness_texture.channel == 1);
    CHECK(material.metallic_texture.channel == 2);
    const std::vector<uint8_t>& color = scene.images[1].rgba8.pixels;
    CHECK(color[0] > 250);
    CHECK(color[1] == 0);
    const std::vector<uint8_t>& surface = scene.images[2].rgba8.pixels;
    CHECK(surface[1] == 64);
    CHECK(surface[2] > 250);
    REQUIRE(messages.left_out().size() == 1);
    CHECK(messages.left_out()[0].find("/materials/0/extensions/KHR_materials_pbrSpecularGlossiness") !=
          std::string::npos);
}

} // namespace specular_glossiness_test
