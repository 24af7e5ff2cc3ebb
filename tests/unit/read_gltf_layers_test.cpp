// Extensions of glTF materials that add layers or change the reflection, and variants of materials.

#include <doctest/doctest.h>

#include "base/write_file_atomically.h"
#include "formats/gltf/read_gltf.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"

using namespace pertev;
using test::GltfBuilder;

namespace {

const std::string kTextures =
    R"(,"textures":[{"source":0}],"images":[{"uri":"data:image/png;base64,)"
    R"(iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC"}])";

/// Reads a document whose one triangle has this material; `extension` is the member of "extensions".
Material read_with(const std::string& extension, Messages& messages, const std::string& pbr = R"("metallicFactor":0)") {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    builder.add("VEC2", std::vector<float>{0, 0, 1, 0, 0, 1});
    return test::read_gltf_text(
               builder.json(R"("meshes":[{"primitives":[{"material":0,"attributes":{"POSITION":0,"TEXCOORD_0":1}}]}],)"
                            R"("nodes":[{"mesh":0}],"materials":[{"pbrMetallicRoughness":{)" +
                            pbr + R"(},"extensions":{)" + extension + "}}]" + kTextures),
               messages)
        .materials.at(0);
}
Material read_with(const std::string& extension, const std::string& pbr = R"("metallicFactor":0)") {
    Messages messages;
    const Material material = read_with(extension, messages, pbr);
    CHECK(messages.all().empty());
    return material;
}

} // namespace

TEST_CASE("a clear coat is read with its factors, channels and normal map") {
    const Material coated =
        read_with(R"("KHR_materials_clearcoat":{"clearcoatFactor":0.75,"clearcoatRoughnessFactor":0.25,)"
                  R"("clearcoatTexture":{"index":0},"clearcoatRoughnessTexture":{"index":0},)"
                  R"("clearcoatNormalTexture":{"index":0,"scale":0.5}})");
    CHECK(coated.kind == MaterialKind::MetallicRoughness);
    CHECK(coated.coat_weight == 0.75f);
    CHECK(coated.coat_roughness == 0.25f);
    CHECK(coated.coat_ior == 1.5f);
    CHECK(coated.coat_normal_scale == 0.5f);
    CHECK(coated.coat_texture.has_image());
    CHECK(coated.coat_texture.channel == 0);
    CHECK(coated.coat_roughness_texture.channel == 1);
    CHECK(coated.coat_normal_texture.has_image());
    CHECK(!coated.coat_texture.is_srgb);
    CHECK(coated.is_stacked());
    const Material smooth = read_with(R"("KHR_materials_clearcoat":{"clearcoatFactor":1})");
    CHECK(smooth.coat_roughness == 0.0f);
    CHECK(smooth.is_stacked());
    const Material none =
        read_with(R"("KHR_materials_clearcoat":{"clearcoatRoughnessFactor":0.5,"clearcoatTexture":{"index":0}})");
    CHECK(!none.is_stacked());
    CHECK(none.textures().empty());
}

TEST_CASE("sheen is read as fuzz, and black sheen is none") {
    const Material velvet =
        read_with(R"("KHR_materials_sheen":{"sheenColorFactor":[0.5,0.25,1],"sheenRoughnessFactor":0.75,)"
                  R"("sheenColorTexture":{"index":0},"sheenRoughnessTexture":{"index":0}})");
    CHECK(velvet.fuzz_weight == 1.0f);
    CHECK(velvet.fuzz_color == Rgb{0.5f, 0.25f, 1});
    CHECK(velvet.fuzz_roughness == 0.75f);
    CHECK(velvet.fuzz_color_texture.is_srgb);
    CHECK(velvet.fuzz_roughness_texture.channel == 3);
    CHECK(!velvet.fuzz_roughness_texture.is_srgb);
    CHECK(velvet.is_stacked());
    CHECK(!read_with(R"("KHR_materials_sheen":{"sheenRoughnessFactor":0.75})").is_stacked());
}

TEST_CASE("the weight and colour of a reflection are read, and without any it is Lambert's law") {
    const Material own = read_with(R"("KHR_materials_specular":{"specularFactor":0.5,"specularColorFactor":[2,1,0],)"
                                   R"("specularTexture":{"index":0},"specularColorTexture":{"index":0}})");
    CHECK(own.kind == MaterialKind::MetallicRoughness);
    CHECK(own.specular_weight == 0.5f);
    CHECK(own.specular_color == Rgb{2, 1, 0});
    CHECK(own.specular_texture.channel == 3);
    CHECK(own.specular_color_texture.is_srgb);
    CHECK(own.is_stacked());
    CHECK(read_with(R"("KHR_materials_specular":{"specularFactor":0})").kind == MaterialKind::Diffuse);
    CHECK(!read_with(R"("KHR_materials_specular":{"specularFactor":0})").is_stacked());
    CHECK(!read_with(R"("KHR_materials_specular":{})").is_stacked());
    const Material metal = read_with(R"("KHR_materials_specular":{"specularFactor":0})", R"("metallicFactor":0.5)");
    CHECK(metal.kind == MaterialKind::MetallicRoughness);
    CHECK(metal.specular_weight == 0.0f);
}

TEST_CASE("transmission without a volume is a thin wall, and with one a share of solid glass") {
    const Material pane =
        read_with(R"("KHR_materials_transmission":{"transmissionFactor":0.5,"transmissionTexture":{"index":0}})");
    CHECK(pane.kind == MaterialKind::MetallicRoughness);
    CHECK(pane.transmission_weight == 0.5f);
    CHECK(pane.transmission_texture.has_image());
    CHECK(pane.transmission_texture.channel == 0);
    CHECK(pane.thin_walled);
    CHECK(pane.is_stacked());
    const std::string thick = R"(,"KHR_materials_volume":{"thicknessFactor":1})";
    CHECK(read_with(R"("KHR_materials_transmission":{"transmissionFactor":1})" + thick).kind ==
          MaterialKind::Dielectric);
    const Material by_texture =
        read_with(R"("KHR_materials_transmission":{"transmissionFactor":1})" + thick, R"("roughnessFactor":0)");
    CHECK(by_texture.kind == MaterialKind::MetallicRoughness);
    CHECK(!by_texture.thin_walled);
    CHECK(by_texture.transmission_weight == 1.0f);
    const Material half = read_with(R"("KHR_materials_transmission":{"transmissionFactor":0.5})" + thick);
    CHECK(!half.thin_walled);
    CHECK(half.transmission_weight == 0.5f);
}

TEST_CASE("retroreflection is read with its texture, and solid glass has none") {
    const Material sign = read_with(R"("KHR_materials_retroreflection":{"retroreflectionFactor":0.75,)"
                                    R"("retroreflectionTexture":{"index":0}})");
    CHECK(sign.specular_retroreflectivity == 0.75f);
    CHECK(sign.retroreflectivity_texture.has_image());
    CHECK(sign.retroreflectivity_texture.channel == 0);
    CHECK(!sign.retroreflectivity_texture.is_srgb);
    CHECK(sign.is_stacked());
    CHECK(!read_with(R"("KHR_materials_retroreflection":{})").is_stacked());
    Messages messages;
    const Material bead = read_with(R"("KHR_materials_retroreflection":{"retroreflectionFactor":1},)"
                                    R"("KHR_materials_transmission":{"transmissionFactor":1},)"
                                    R"("KHR_materials_volume":{"thicknessFactor":1})",
                                    messages);
    CHECK(bead.specular_retroreflectivity == 0.0f);
    CHECK(messages.left_out().size() == 1);
}

TEST_CASE("dispersion is read as Abbe's number, of solids alone") {
    const std::string solid = R"(,"KHR_materials_transmission":{"transmissionFactor":1},)"
                              R"("KHR_materials_volume":{"thicknessFactor":1})";
    const Material flint = read_with(R"("KHR_materials_dispersion":{"dispersion":0.5})" + solid);
    CHECK(flint.transmission_dispersion_scale == 0.5f);
    CHECK(flint.dispersion() == 0.025f); // the reciprocal of 20 / 0.5
    CHECK(flint.is_stacked());
    CHECK(read_with(R"("KHR_materials_dispersion":{"dispersion":4})" + solid).dispersion() == 0.2f);
    CHECK(read_with(R"("KHR_materials_dispersion":{"dispersion":400})" + solid).dispersion() == 1.0f);
    CHECK(read_with(R"("KHR_materials_dispersion":{})" + solid).dispersion() == 0.0f);
    CHECK(!read_with(R"("KHR_materials_dispersion":{"dispersion":1})").is_stacked());
    Messages messages;
    CHECK(read_with(R"("KHR_materials_dispersion":{"dispersion":-1})" + solid, messages).dispersion() == 0.0f);
    CHECK(messages.left_out().size() == 1);
}

TEST_CASE("anisotropy, a thin film and diffuse transmission are read with their textures") {
    const Material brushed = read_with(R"("KHR_materials_anisotropy":{"anisotropyStrength":0.5,)"
                                       R"("anisotropyRotation":0.25,"anisotropyTexture":{"index":0}})");
    CHECK(brushed.specular_roughness_anisotropy == 0.5f);
    CHECK(brushed.anisotropy_rotation == 0.25f);
    CHECK(brushed.anisotropy_texture.has_image());
    CHECK(!brushed.anisotropy_texture.is_srgb);
    CHECK(brushed.is_stacked());
    CHECK(!read_with(R"("KHR_materials_anisotropy":{"anisotropyRotation":1})").is_stacked());
    const Material bubble = read_with(R"("KHR_materials_iridescence":{"iridescenceFactor":0.5,"iridescenceIor":1.25,)"
                                      R"("iridescenceThicknessMinimum":200,"iridescenceThicknessMaximum":700,)"
                                      R"("iridescenceTexture":{"index":0},"iridescenceThicknessTexture":{"index":0}})");
    CHECK(bubble.thin_film_weight == 0.5f);
    CHECK(bubble.thin_film_ior == 1.25f);
    CHECK(bubble.thin_film_least_nm == 200.0f);
    CHECK(bubble.thin_film_thickness_nm == 700.0f);
    CHECK(bubble.thin_film_texture.channel == 0);
    CHECK(bubble.thin_film_thickness_texture.channel == 1);
    CHECK(bubble.is_stacked());
    const Material usual = read_with(R"("KHR_materials_iridescence":{"iridescenceFactor":1})");
    CHECK(usual.thin_film_ior == 1.3f);
    CHECK(usual.thin_film_least_nm == 100.0f);
    CHECK(usual.thin_film_thickness_nm == 400.0f);
    const Material leaf =
        read_with(R"("KHR_materials_diffuse_transmission":{"diffuseTransmissionFactor":0.25,)"
                  R"("diffuseTransmissionColorFactor":[0.5,1,0.25],"diffuseTransmissionTexture":{"index":0},)"
                  R"("diffuseTransmissionColorTexture":{"index":0}})");
    CHECK(leaf.diffuse_transmission_weight == 0.25f);
    CHECK(leaf.diffuse_transmission_color == Rgb{0.5f, 1, 0.25f});
    CHECK(leaf.diffuse_transmission_texture.channel == 3);
    CHECK(leaf.diffuse_transmission_color_texture.is_srgb);
    CHECK(leaf.is_stacked());
    Messages messages;
    CHECK(read_with(R"("KHR_materials_transmission":{"transmissionFactor":1},)"
                    R"("KHR_materials_volume":{"thicknessFactor":1,"attenuationDistance":0})",
                    messages)
              .transmission_depth == 0.0f);
    CHECK(test::has_warning(messages, {"/materials/0/extensions/KHR_materials_volume/attenuationDistance"}));
}

TEST_CASE("an unreadable member of a layer is left out alone") {
    Messages messages;
    const Material material =
        read_with(R"("KHR_materials_clearcoat":{"clearcoatFactor":1,"clearcoatRoughnessFactor":"a"},)"
                  R"("KHR_materials_sheen":{"sheenColorFactor":[1,1],"sheenRoughnessFactor":0.5})",
                  messages);
    CHECK(material.coat_weight == 1.0f);
    CHECK(!material.has_fuzz());
    CHECK(test::has_warning(messages, {"clearcoatRoughnessFactor"}));
    CHECK(test::has_warning(messages, {"sheenColorFactor"}));
}

TEST_CASE("a variant chooses the materials of the primitives that have a mapping for it") {
    GltfBuilder builder;
    builder.add("VEC3", std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0});
    const std::string text = builder.json(
        R"("extensions":{"KHR_materials_variants":{"variants":[{"name":"day"},{"name":"night"}]}},)"
        R"("meshes":[{"primitives":[{"material":0,"attributes":{"POSITION":0},"extensions":{"KHR_materials_variants":)"
        R"({"mappings":[{"material":1,"variants":[0]},{"material":2,"variants":[1]}]}}},)"
        R"({"material":0,"attributes":{"POSITION":0},"extensions":{"KHR_materials_variants":)"
        R"({"mappings":[{"material":2,"variants":[1]}]}}}]}],)"
        R"("nodes":[{"mesh":0}],"materials":[{"name":"a"},{"name":"b"},{"name":"c"}])");
    const auto folder = test::scratch_folder();
    write_file_atomically(folder / "model.gltf", std::as_bytes(std::span(text)));
    const auto names = [&](const std::string& variant) {
        Messages messages;
        ReadOptions options;
        options.variant = variant;
        const Scene scene = read_gltf(folder / "model.gltf", FileAccess(folder / "model.gltf", {}), options, messages);
        CHECK(scene.variants == std::vector<std::string>{"day", "night"});
        std::string used;
        for (const Instance& instance : scene.instances) used += scene.materials[instance.material].name;
        return used;
    };
    CHECK(names("") == "aa");
    CHECK(names("day") == "ba");
    CHECK(names("night") == "cc");
    CHECK(names("1") == "cc");
    const auto error = test::thrown_error([&] { names("dusk"); });
    CHECK(test::is_about(error, ErrorCode::BadInput, "variant", "dusk"));
    CHECK(test::says(error, "day"));
    CHECK(test::says(error, "night"));
}
