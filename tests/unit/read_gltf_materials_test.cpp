// glTF materials, textures, samplers and images.

#include <doctest/doctest.h>

#include <cmath>

#include "base/write_file_atomically.h"
#include "formats/gltf/read_gltf.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/options.h"

using namespace pertev;
using test::GltfBuilder;

namespace {

// A PNG of one pixel, (255, 0, 0).
const std::string kRedPng =
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC";
const std::string kImage = R"("images":[{"uri":"data:image/png;base64,)" + kRedPng + R"("}])";

/// A document whose one triangle has material 0; `materials` are the elements of the array.
std::string with_material(const std::string& materials, const std::string& members = "") {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    return builder.json(R"("meshes":[{"primitives":[{"material":0,"attributes":{"POSITION":0}}]}],)"
                        R"("nodes":[{"mesh":0}],"materials":[)" +
                        materials + "]" + members);
}

Material read_material(const std::string& material, const std::string& members = "") {
    return test::read_gltf_text(with_material(material, members)).materials.at(0);
}

} // namespace

TEST_CASE("every factor of a metallic-roughness material is read") {
    const Material material = read_material(
        R"({"name":"m","pbrMetallicRoughness":{"baseColorFactor":[0.1,0.2,0.3,0.4],"metallicFactor":0.5,)"
        R"("roughnessFactor":0.6},"emissiveFactor":[1,0.5,0.25],"alphaMode":"MASK","alphaCutoff":0.7,)"
        R"("extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":4},"KHR_materials_ior":{"ior":1.33}}})");
    CHECK(material.name == "m");
    CHECK(material.kind == MaterialKind::MetallicRoughness);
    CHECK(material.base_color == Rgb{0.1f, 0.2f, 0.3f});
    CHECK(material.alpha == 0.4f);
    CHECK(material.metallic == 0.5f);
    CHECK(material.roughness == 0.6f);
    CHECK(material.emission == Rgb{4, 2, 1});
    CHECK(material.alpha_mode == AlphaMode::Mask);
    CHECK(material.alpha_cutoff == 0.7f);
    CHECK(material.ior == 1.33f);
    CHECK(!material.base_color_texture.has_image());
}

TEST_CASE("an index of 0 is infinite, and one below 1 is that of a bubble over what surrounds it") {
    const auto index = [](const std::string& ior) {
        return read_material(R"({"extensions":{"KHR_materials_ior":{"ior":)" + ior + "}}}");
    };
    CHECK(index("0").ior == kMostIor);
    CHECK_FALSE(index("0").has_relative_ior);
    CHECK(index("0.75").ior == 0.75f);
    CHECK(index("0.75").has_relative_ior);
    CHECK(index("-1").ior == 1.5f);
    CHECK_FALSE(index("1.5").has_relative_ior);
}

TEST_CASE("a material without properties is a white, rough and opaque metal") {
    const Material material = read_material("{}");
    CHECK(material.kind == MaterialKind::MetallicRoughness);
    CHECK(material.base_color == Rgb{1, 1, 1});
    CHECK(material.metallic == 1.0f);
    CHECK(material.roughness == 1.0f);
    CHECK(material.ior == 1.5f);
    CHECK(material.alpha_mode == AlphaMode::Opaque);
    CHECK(!material.is_emissive());
    CHECK(read_material(R"({"alphaMode":"BLEND"})").alpha_mode == AlphaMode::Blend);
    CHECK(read_material(R"({"extensions":{"KHR_materials_unlit":{}}})").kind == MaterialKind::Unlit);
    Material glowing = read_material(R"({"emissiveFactor":[1,0,0]})");
    CHECK(glowing.is_emitter());
    glowing.kind = MaterialKind::Unlit;
    CHECK(glowing.is_emissive());
    CHECK(!glowing.is_emitter());
}

TEST_CASE("doubleSided makes backs visible and emissive") {
    for (const std::string text : {"{}", R"({"doubleSided":false})"}) {
        const Material material = read_material(text);
        CHECK_FALSE(material.double_sided);
        CHECK_FALSE(material.two_sided_emission);
    }
    const Material both = read_material(R"({"doubleSided":true})");
    CHECK(both.double_sided);
    CHECK(both.two_sided_emission);
}

TEST_CASE("solid clear glass is a dielectric, and nothing of a volume is left out") {
    const auto read = [](const std::string& transmission, const std::string& volume, bool is_glass) {
        CAPTURE(transmission);
        CAPTURE(volume);
        Messages messages;
        const Scene scene = test::read_gltf_text(
            with_material(R"({"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0},"extensions":{)"
                          R"("KHR_materials_ior":{"ior":1.25},"KHR_materials_transmission":{)" +
                          transmission + R"(},"KHR_materials_volume":{)" + volume + "}}}"),
            messages);
        const Material& material = scene.materials.at(0);
        CHECK(material.kind == (is_glass ? MaterialKind::Dielectric : MaterialKind::MetallicRoughness));
        CHECK(material.ior == 1.25f);
        CHECK(messages.all().empty());
        return material;
    };
    read(R"("transmissionFactor":1)", R"("thicknessFactor":1)", true);
    const Material absorbing =
        read(R"("transmissionFactor":1)",
             R"("thicknessFactor":1,"attenuationDistance":2,"attenuationColor":[0.25,0.5,1])", true);
    CHECK(absorbing.transmission_color == Rgb{0.25f, 0.5f, 1});
    CHECK(absorbing.transmission_depth == 2.0f);
    CHECK(absorbing.absorbs());
    CHECK(absorbing.is_stacked());
    CHECK(!read(R"("transmissionFactor":1)", R"("thicknessFactor":1,"attenuationDistance":2)", true).is_stacked());
    CHECK(!read(R"("transmissionFactor":1)", R"("attenuationDistance":2,"attenuationColor":[0,0,0])", false).absorbs());
    CHECK(read(R"("transmissionFactor":0.5)", R"("thicknessFactor":1)", false).transmission_weight == 0.5f);
    read(R"("transmissionFactor":1)", "", false);
    read("", R"("thicknessFactor":1)", false);
}

TEST_CASE("each texture slot gets its image, its channel and its encoding") {
    const Material material = read_material(
        R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0},"metallicRoughnessTexture":{"index":0}},)"
        R"("normalTexture":{"index":0,"scale":0.5},"occlusionTexture":{"index":0},"emissiveTexture":{"index":0}})",
        R"(,"textures":[{"source":0}],)" + kImage);
    CHECK(material.base_color_texture.image == 0);
    CHECK(material.base_color_texture.is_srgb);
    CHECK(material.roughness_texture.image == 0);
    CHECK(material.roughness_texture.channel == 1);
    CHECK(!material.roughness_texture.is_srgb);
    CHECK(material.metallic_texture.image == 0);
    CHECK(material.metallic_texture.channel == 2);
    CHECK(material.normal_texture.image == 0);
    CHECK(!material.normal_texture.is_srgb);
    CHECK(material.normal_scale == 0.5f);
    CHECK(material.emission_texture.image == 0);
    CHECK(material.emission_texture.is_srgb);
    CHECK(material.base_color_texture.wrap_s == Wrap::Repeat);
    CHECK(material.base_color_texture.filter == TextureFilter::Linear);
}

TEST_CASE("images come from data URIs, buffer views and files, each read once and only if used") {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("VEC2", std::vector<float>{0, 0, 1, 0, 0, 1});
    const auto png = [] { // kRedPng in base64
        std::vector<uint8_t> bytes;
        uint32_t bits = 0;
        int held = 0;
        const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        for (const char c : kRedPng) {
            if (c == '=') break;
            bits = bits << 6 | static_cast<uint32_t>(digits.find(c));
            held += 6;
            if (held < 8) continue;
            held -= 8;
            bytes.push_back(static_cast<uint8_t>(bits >> held));
        }
        return bytes;
    }();
    const int view = builder.add_view(png);
    const auto folder = test::scratch_folder();
    write_file_atomically(folder / "r%.png", std::as_bytes(std::span(png)));
    const std::string text = builder.json(
        R"("meshes":[{"primitives":[{"material":0,"attributes":{"POSITION":0,"TEXCOORD_0":1}},)"
        R"({"material":1,"attributes":{"POSITION":0,"TEXCOORD_0":1}}]}],)"
        R"("nodes":[{"mesh":0}],"materials":[)"
        R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}},"emissiveTexture":{"index":1},"normalTexture":{"index":2}},)"
        R"({"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}},{"emissiveTexture":{"index":3}}],)"
        R"("textures":[{"source":0},{"source":1},{"source":2},{"source":3}],"images":[{"uri":"data:image/png;base64,)" +
        kRedPng + R"("},{"mimeType":"image/png","bufferView":)" + std::to_string(view) +
        R"(},{"uri":"r%25.png"},{"uri":"unused-and-not-there.png"}])");
    write_file_atomically(folder / "model.gltf", std::as_bytes(std::span(text)));
    Messages messages;
    const Scene scene = read_gltf(folder / "model.gltf", FileAccess(folder / "model.gltf", {}), {}, messages);
    CHECK(messages.all().empty());
    REQUIRE(scene.images.size() == 3);
    for (const TextureImage& image : scene.images) CHECK(image.rgba8.pixels == std::vector<uint8_t>{255, 0, 0, 255});
    REQUIRE(scene.materials.size() == 2);
    CHECK(scene.materials[0].base_color_texture.image == scene.materials[1].base_color_texture.image);
    CHECK(scene.materials[0].emission_texture.image == 1);
    CHECK(scene.materials[0].normal_texture.image == 2);
}

TEST_CASE("a sampler's wrap modes and filters are read") {
    const auto read = [](const std::string& sampler) {
        return read_material(R"({"emissiveTexture":{"index":0}})",
                             R"(,"textures":[{"source":0,"sampler":0}],"samplers":[)" + sampler + "]," + kImage)
            .emission_texture;
    };
    const TextureRef clamped = read(R"({"wrapS":33071,"wrapT":33648,"magFilter":9728,"minFilter":9987})");
    CHECK(clamped.wrap_s == Wrap::ClampToEdge);
    CHECK(clamped.wrap_t == Wrap::MirroredRepeat);
    CHECK(clamped.filter == TextureFilter::Nearest);
    const TextureRef repeated = read(R"({"wrapS":10497,"magFilter":9729,"minFilter":9728})");
    CHECK(repeated.wrap_s == Wrap::Repeat);
    CHECK(repeated.wrap_t == Wrap::Repeat);
    CHECK(repeated.filter == TextureFilter::Linear);
    CHECK(
        test::gltf_fault(with_material(R"({"emissiveTexture":{"index":0}})",
                                       R"(,"textures":[{"source":0,"sampler":0}],"samplers":[{"wrapS":1}],)" + kImage))
            .starts_with("model.gltf: /samplers/0/wrapS: "));
}

TEST_CASE("a texture transform is translation * rotation * scale, and a rotation takes (1, 0) towards (0, -1)") {
    const TextureRef texture =
        read_material(R"({"emissiveTexture":{"index":0,"texCoord":0,"extensions":{"KHR_texture_transform":)"
                      R"({"offset":[0.25,-0.5],"rotation":0.5,"scale":[2,3],"texCoord":1}}}})",
                      R"(,"textures":[{"source":0}],)" + kImage)
            .emission_texture;
    const double s = std::sin(0.5), c = std::cos(0.5);
    CHECK(texture.uv_set == 1);
    CHECK(texture.m00 == doctest::Approx(2 * c).epsilon(1e-6));
    CHECK(texture.m01 == doctest::Approx(3 * s).epsilon(1e-6));
    CHECK(texture.m02 == 0.25f);
    CHECK(texture.m10 == doctest::Approx(-2 * s).epsilon(1e-6));
    CHECK(texture.m11 == doctest::Approx(3 * c).epsilon(1e-6));
    CHECK(texture.m12 == -0.5f);

    // The extension's own example shows the lower left quadrant: u in [0, 1/2], v (down) in [1/2, 1].
    const TextureRef example = read_material(R"({"emissiveTexture":{"index":0,"extensions":{"KHR_texture_transform":)"
                                             R"({"offset":[0,1],"rotation":1.57079632679,"scale":[0.5,0.5]}}}})",
                                             R"(,"textures":[{"source":0}],)" + kImage)
                                   .emission_texture;
    for (const Vec2 uv : {Vec2{0, 0}, Vec2{1, 0}, Vec2{0, 1}, Vec2{1, 1}}) {
        const float u = example.m00 * uv.x + example.m01 * uv.y + example.m02;
        const float v = example.m10 * uv.x + example.m11 * uv.y + example.m12;
        CHECK(u == doctest::Approx(0.5 * static_cast<double>(uv.y)));
        CHECK(v == doctest::Approx(1 - 0.5 * static_cast<double>(uv.x)));
    }
}

TEST_CASE("textures that cannot be read cause warnings, and the factor stays") {
    const auto read = [](const std::string& info, const std::string& members, const std::string& warning) {
        CAPTURE(warning);
        Messages messages;
        const Scene scene =
            test::read_gltf_text(with_material(R"({"emissiveTexture":)" + info + "}", members), messages);
        CHECK(!scene.materials.at(0).emission_texture.has_image());
        CHECK(test::has_warning(messages, {"model.gltf", warning}));
    };
    read(R"({"index":0,"texCoord":256})", R"(,"textures":[{"source":0}],)" + kImage, "/materials/0/emissiveTexture");
    read(R"({"index":0})", R"(,"textures":[{}])", "/textures/0");
    read(R"({"index":0})", R"(,"textures":[{"source":0}],"images":[{"uri":"none.png"}])", "none.png");
    read(R"({"index":0})", R"(,"textures":[{"source":0}],"images":[{"uri":"data:image/png;base64,AAAA"}])",
         "/images/0");
    read(R"({"index":0})", R"(,"textures":[{"source":0}],"images":[{"uri":"data:image/png,AAAA"}])", "/images/0");
    read(R"({"index":0})", R"(,"textures":[{"source":0}],"images":[{"uri":"data:image/png,%A"}])", "/images/0/uri");
}

TEST_CASE("an image outside the allowed folders is left out with its pointer") {
    const auto error = [](const std::string& uri) {
        return test::gltf_fault(with_material(R"({"normalTexture":{"index":0}})",
                                              R"(,"textures":[{"source":0}],"images":[{"uri":")" + uri + "\"}]"));
    };
    std::string up; // leads to the root from any depth
    for (int i = 0; i < 30; ++i) up += "../";
    const std::string outside = error(up + "etc/passwd"); // an existing file
    CHECK(outside.starts_with("model.gltf: /images/0/uri: "));
    CHECK(outside.find("`allow_path=") != std::string::npos);
    CHECK(error("").starts_with("model.gltf: /images/0/uri: "));
    CHECK(error("http://a/x.png").starts_with("model.gltf: /images/0/uri: "));
}

TEST_CASE("a texture over missing texture coordinates causes a warning with the material's pointer") {
    const auto read = [](const std::string& material) {
        GltfBuilder builder;
        builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
        builder.add("VEC2", std::vector<float>{0, 0, 1, 0, 0, 1});
        Messages messages;
        const Scene scene = test::read_gltf_text(
            builder.json(R"("meshes":[{"primitives":[{"material":0,"attributes":{"POSITION":0,"TEXCOORD_0":1}}]}],)"
                         R"("nodes":[{"mesh":0}],"textures":[{"source":0}],)" +
                         kImage + ",\"materials\":[" + material + "]"),
            messages);
        CHECK(scene.images.size() == 1);
        return messages;
    };
    CHECK(read(R"({"emissiveTexture":{"index":0}})").all().empty());
    for (const std::string slot : {"emissiveTexture", "normalTexture"}) {
        const Messages messages = read("{\"" + slot + R"(":{"index":0,"texCoord":1}})");
        CHECK(test::has_warning(messages, {"model.gltf: /materials/0: a texture uses TEXCOORD_1"}));
        CHECK(messages.all().size() == 1);
    }
}

TEST_CASE("reading only geometry reads no material and opens no image") {
    Messages messages;
    const Scene scene =
        test::read_gltf_text(with_material(R"({"emissiveTexture":{"index":0}})",
                                           R"(,"textures":[{"source":0}],"images":[{"uri":"none.png"}])"),
                             messages, true);
    CHECK(messages.all().empty());
    CHECK(scene.images.empty());
    REQUIRE(scene.materials.size() == 1);
    CHECK(scene.materials[0].kind == MaterialKind::Diffuse);
}
