#include <algorithm>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "formats/pbrt/materials.h"
#include "formats/read_scene.h"
#include "image/srgb.h"
#include "image/write_image.h"
#include "math/portable_math.h"
#include "scene/metals.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

const std::string kFace =
    "Shape \"trianglemesh\" \"point3 P\" [0 0 0 2 0 0 0 2 0] \"point2 uv\" [0 0 1 0 0 1] \"integer indices\" [0 1 2]\n";

struct OneMaterial {
    Scene scene;
    Material material;
    Messages messages;
};

/// Reads a file of one face, in a folder with the pictures a.exr (two pixels of 0.25 and 0.5) and a.png.
OneMaterial load_pbrt_material(const std::string& text, const std::string& end = "") {
    const fs::path folder = test::scratch_folder();
    write_image(folder / "a.exr",
                Image{.width = 2, .height = 1, .channels = 3, .pixels = {0.25f, 0.25f, 0.25f, 0.5f, 0.5f, 0.5f}});
    OneMaterial read;
    read.scene = read_scene(test::write_text(folder / "scene.pbrt", "WorldBegin\n" + text + "\n" + kFace + end), {},
                            read.messages);
    if (!read.scene.instances.empty()) read.material = read.scene.materials[read.scene.instances[0].material];
    return read;
}

Material pbrt_material(const std::string& text, const std::string& end = "") {
    const OneMaterial read = load_pbrt_material(text, end);
    CHECK(read.messages.left_out() == std::vector<std::string>{});
    return read.material;
}

/// The colour of a texture's image at texture coordinates with v upwards, from the nearest pixel.
float pbrt_texel(const Scene& scene, const TextureRef& ref, float u, float v) {
    const Image& image = scene.images.at(static_cast<std::size_t>(ref.image)).rgba_float;
    const float x = ref.m00 * u + ref.m01 * (1 - v) + ref.m02, y = ref.m10 * u + ref.m11 * (1 - v) + ref.m12;
    const auto column = static_cast<uint32_t>((x - floor(x)) * float(image.width)),
               row = static_cast<uint32_t>((y - floor(y)) * float(image.height));
    return image.pixels.at(4 * (std::size_t(row) * image.width + column));
}

} // namespace

TEST_CASE("pbrt: diffuse, conductor and dielectric have their numbers, and microfacets of one bounce") {
    const Material diffuse = pbrt_material("Material \"diffuse\" \"rgb reflectance\" [.1 .2 .3]");
    CHECK(diffuse.kind == MaterialKind::Diffuse);
    CHECK(diffuse.base_color == Rgb{0.1f, 0.2f, 0.3f});
    CHECK(pbrt_material("").base_color == grey(0.5f));
    const Material gold = pbrt_material("Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" "
                                        "\"metal-Au-k\" \"float roughness\" .0625");
    CHECK(gold.kind == MaterialKind::Conductor);
    CHECK(gold.eta == find_metal("gold")->eta);
    CHECK(gold.k == find_metal("gold")->k);
    CHECK(gold.roughness == doctest::Approx(0.5)); // the width is the root, and its root the roughness
    CHECK(gold.energy == MicrofacetEnergy::Single);
    CHECK(gold.microfacet_distribution == MicrofacetDistribution::Ggx);
    CHECK(pbrt_material("Material \"conductor\"").eta == find_metal("copper")->eta);
    const Material half = pbrt_material("Material \"conductor\" \"rgb reflectance\" [.5 .5 .5]");
    CHECK(half.eta == grey(1));
    CHECK(square(half.k.r) / (4 + square(half.k.r)) == doctest::Approx(0.5)); // Fresnel at 0 degrees
    const Material water = pbrt_material("Material \"dielectric\" \"float eta\" 1.33");
    CHECK(water.kind == MaterialKind::Dielectric);
    CHECK(water.ior == 1.33f);
    CHECK(water.roughness == 0);
    CHECK(water.base_color == grey(1));
    CHECK(water.dispersion() == 0);
    CHECK(water.has_relative_ior); // pbrt's interfaces do not know what surrounds them
    CHECK(pbrt_material("Material \"dielectric\" \"float eta\" .75").ior == 0.75f);
    CHECK(pbrt_material("Material \"glass\" \"float eta\" .75").ior == 0.75f);
    const Material glass = pbrt_material("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"");
    CHECK(glass.ior == doctest::Approx(1.5168));
    CHECK(glass.transmission_dispersion_abbe_number == doctest::Approx(64.17));
    CHECK(glass.dispersion() > 0);
}

TEST_CASE("pbrt: an index that is none is left out for the default, and a bubble's is not one of an opaque surface") {
    struct Case {
        const char* material;
        float ior;
    };
    for (const Case& c : {Case{"\"glass\" \"float eta\" 0", 1.5f},
                          {"\"dielectric\" \"float eta\" 0", 1.5f},
                          {"\"dielectric\" \"float eta\" -2", 1.5f},
                          {"\"coateddiffuse\" \"float eta\" 0", 1.5f},
                          {"\"disney\" \"float eta\" .75", 1}}) {
        CAPTURE(c.material);
        const OneMaterial read = load_pbrt_material(std::string("Material ") + c.material);
        CHECK(read.material.ior == c.ior);
        const std::vector<std::string> said = read.messages.left_out();
        CHECK(std::ranges::count_if(said, [](const std::string& text) {
                  return text.find("the index of refraction") != std::string::npos;
              }) == 1);
    }
    CHECK(pbrt_material("Material \"disney\" \"float eta\" .75 \"float spectrans\" 1").ior == 0.75f);
}

TEST_CASE("pbrt: the parts of disney are as bright as pbrt's") {
    const Material plain = pbrt_material("Material \"disney\"");
    CHECK(plain.base_color.r == doctest::Approx(0.5f * 1.1f).epsilon(0.05)); // ours is dimmed by the reflection above
    CHECK(plain.specular_weight == 1);
    CHECK(pbrt_material("Material \"disney\" \"float eta\" 1").specular_weight == 0);
    const Material clear =
        pbrt_material("Material \"disney\" \"rgb color\" [.25 .25 .25] \"float spectrans\" 1 \"float sheen\" 1");
    CHECK(clear.base_color.r == doctest::Approx(0.5)); // both interfaces together have the colour
    CHECK(clear.fuzz_weight == 0);
    const Material layered =
        pbrt_material("Material \"disney\" \"float clearcoat\" 1 \"float clearcoatgloss\" 0 \"float sheen\" 1");
    CHECK(layered.coat_weight == 0.25f);
    CHECK(layered.coat_roughness == doctest::Approx(std::sqrt(0.1)));
    CHECK(layered.fuzz_weight == 0.09f);
}

TEST_CASE("pbrt: a coat that is rough along one direction alone is not smooth") {
    const Material coat = pbrt_material("Material \"coateddiffuse\" \"float uroughness\" .3 \"float vroughness\" 0");
    CHECK(coat.roughness == 0);
    CHECK(coat.energy == MicrofacetEnergy::Single);
    CHECK(pbrt_material("Material \"coateddiffuse\"").energy == MicrofacetEnergy::Compensated);
}

TEST_CASE("pbrt: roughness is remapped as each version does, and may differ along u and v") {
    CHECK(pbrt_material("Material \"dielectric\" \"float roughness\" .25 \"bool remaproughness\" false").roughness ==
          doctest::Approx(0.5));
    CHECK(pbrt_material("Material \"dielectric\" \"float roughness\" .0625 \"bool remaproughness\" true").roughness ==
          doctest::Approx(0.5));
    // pbrt-v3: log 1 = 0, so that a roughness of 1 has the width 1.62142.
    CHECK(described::converted(described::Curve::RoughnessOfVersion3, 0, 1) == 1);
    CHECK(square(described::converted(described::Curve::RoughnessOfVersion3, 0, 0.1f)) ==
          doctest::Approx(0.46176).epsilon(1e-4));
    const Material along = pbrt_material(
        "Material \"conductor\" \"float uroughness\" .5 \"float vroughness\" .1 \"bool remaproughness\" false");
    CHECK(square(along.roughness) == doctest::Approx(0.1));
    const float strength = square(along.specular_roughness_anisotropy);
    CHECK(0.1f + 0.9f * strength == doctest::Approx(0.5));
    CHECK(along.anisotropy_rotation == 0);
    const Material across = pbrt_material(
        "Material \"conductor\" \"float uroughness\" .1 \"float vroughness\" .5 \"bool remaproughness\" false");
    CHECK(across.anisotropy_rotation == doctest::Approx(kPi / 2));
    CHECK(across.specular_roughness_anisotropy == along.specular_roughness_anisotropy);
}

TEST_CASE("pbrt: glass of version 3 is smooth at roughness 0, which its other materials remap") {
    const std::string at_0 = " \"float uroughness\" 0 \"float vroughness\" 0", along = " \"float uroughness\" .1";
    for (const std::string type : {"glass", "kdsubsurface"}) {
        CAPTURE(type);
        CHECK(pbrt_material("Material \"" + type + "\"").roughness == 0);
        CHECK(pbrt_material("Material \"" + type + "\"" + at_0).roughness == 0);
        const Material rough = pbrt_material("Material \"" + type + "\"" + along);
        CHECK(square(rough.roughness) == doctest::Approx(0.0473).epsilon(2e-3)); // that of 1e-3
        CHECK(rough.specular_roughness_anisotropy > 0.5f);
    }
    // Only version 3 ends a world.
    CHECK(pbrt_material("Material \"subsurface\"", "WorldEnd\n").roughness == 0);
    CHECK(square(pbrt_material("Material \"metal\"" + at_0).roughness) == doctest::Approx(0.0473).epsilon(2e-3));
    CHECK(described::converted(described::Curve::RoughnessOfGlass3, 0, 0.1f) ==
          described::converted(described::Curve::RoughnessOfVersion3, 0, 0.1f));
    const OneMaterial read =
        load_pbrt_material("Texture \"t\" \"float\" \"checkerboard\" \"float tex1\" 0 \"float tex2\" 1\n"
                           "Material \"glass\" \"texture uroughness\" \"t\" \"texture vroughness\" \"t\"");
    CHECK(pbrt_texel(read.scene, read.material.roughness_texture, 0.2f, 0.2f) == 0);
    CHECK(pbrt_texel(read.scene, read.material.roughness_texture, 1.2f, 0.2f) == 1);
}

TEST_CASE("pbrt: coats, panes and sheets are the nearest materials") {
    // 59.6 % of diffuse light inside glass of 1.5 is reflected back.
    CHECK(described::reflected_inside(1.5f) == doctest::Approx(0.5963).epsilon(2e-3));
    CHECK(described::reflected_inside(1) == doctest::Approx(0).epsilon(1e-3));
    const Material coated = pbrt_material("Material \"coateddiffuse\" \"rgb reflectance\" [1 .5 0]");
    CHECK(coated.kind == MaterialKind::MetallicRoughness);
    CHECK(coated.base_color.r == doctest::Approx(1).epsilon(1e-2)); // Schlick lets a little more in
    CHECK(coated.base_color.g == doctest::Approx(0.5 * 0.4037 / (1 - 0.5 * 0.5963)).epsilon(1e-2));
    CHECK(coated.base_color.b == 0);
    CHECK(coated.metallic == 0);
    const Material lacquer = pbrt_material("Material \"coatedconductor\" \"float interface.roughness\" .0625 \"float "
                                           "conductor.roughness\" 0 \"float interface.eta\" 1.6");
    CHECK(lacquer.kind == MaterialKind::Conductor);
    CHECK(lacquer.coat_weight == 1);
    CHECK(lacquer.coat_ior == 1.6f);
    CHECK(lacquer.coat_roughness == doctest::Approx(0.5));
    CHECK(lacquer.roughness == 0);
    const Material brushed = pbrt_material("Material \"coatedconductor\" \"float interface.uroughness\" .01 \"float "
                                           "interface.vroughness\" .16 \"bool remaproughness\" false");
    CHECK(brushed.coat_roughness == doctest::Approx(0.1));
    CHECK(square(brushed.coat_roughness_anisotropy) == doctest::Approx(0.15 / 0.99));
    CHECK(brushed.coat_anisotropy_rotation == doctest::Approx(kPi / 2));
    CHECK(!brushed.has_anisotropy()); // the metal beneath is even
    const Material pane = pbrt_material("Material \"thindielectric\" \"float eta\" 1.5");
    CHECK(pane.transmission_weight == 1);
    CHECK(pane.thin_walled);
    CHECK(square((pane.ior - 1) / (pane.ior + 1)) == doctest::Approx(2 * 0.04 / 1.04)); // both sides reflect
    const Material sheet = pbrt_material(
        "Material \"diffusetransmission\" \"rgb reflectance\" [.3 .2 .1] \"rgb transmittance\" [.6 .4 .2]");
    const float far = sheet.diffuse_transmission_weight;
    CHECK((1 - far) * sheet.base_color.r == doctest::Approx(0.3));
    CHECK((1 - far) * sheet.base_color.b == doctest::Approx(0.1));
    CHECK(far * sheet.diffuse_transmission_color.r == doctest::Approx(0.6));
    CHECK(far * sheet.diffuse_transmission_color.g == doctest::Approx(0.4));
    CHECK(sheet.specular_weight == 0);
}

TEST_CASE("pbrt: materials of version 3 become those of version 4") {
    CHECK(pbrt_material("Material \"matte\" \"rgb Kd\" [.1 .2 .3]", "WorldEnd\n").base_color == Rgb{0.1f, 0.2f, 0.3f});
    CHECK(pbrt_material("Material \"matte\" \"color Kd\" [.1 .2 .3] \"float sigma\" 20").base_diffuse_roughness > 0);
    const Material metal = pbrt_material("Material \"metal\" \"rgb eta\" [1.1 1.2 1.3] \"rgb k\" [3 4 5] \"float "
                                         "uroughness\" .25 \"float vroughness\" .25 \"bool remaproughness\" false");
    CHECK(metal.kind == MaterialKind::Conductor);
    CHECK(metal.eta == Rgb{1.1f, 1.2f, 1.3f});
    CHECK(metal.k == Rgb{3, 4, 5});
    CHECK(metal.roughness == doctest::Approx(0.5));
    const Material glass = pbrt_material("Material \"glass\" \"float index\" 1.7 \"rgb Kt\" [0 0 0]");
    CHECK(glass.kind == MaterialKind::Dielectric);
    CHECK(glass.ior == 1.7f);
    CHECK(glass.base_color == grey(0));
    const Material plastic = pbrt_material("Material \"plastic\" \"rgb Kd\" [.1 .1 .1] \"rgb Ks\" [.4 .2 .2]");
    // A coat of 0.4 of glass sends 0.4 of 59.6 % back inside.
    CHECK(plastic.base_color.r == doctest::Approx(0.1 * (1 - 0.4 * 0.5963) / (1 - 0.1 * 0.4 * 0.5963)).epsilon(2e-3));
    CHECK(plastic.specular_weight * plastic.specular_color.r == doctest::Approx(0.4));
    CHECK(plastic.specular_weight * plastic.specular_color.g == doctest::Approx(0.2));
    const Material substrate = pbrt_material("Material \"substrate\" \"rgb Ks\" [.04 .08 .04]");
    // At 0 degrees Ks is reflected.
    CHECK(square((substrate.ior - 1) / (substrate.ior + 1)) * substrate.specular_color.g == doctest::Approx(0.08));
    CHECK(pbrt_material("Material \"substrate\" \"rgb Ks\" [.04 .04 .04] \"rgb Kd\" [.5 .5 .5]").base_color.g ==
          doctest::Approx(0.5 * 0.4037 / (1 - 0.5 * 0.5963)).epsilon(2e-3)); // coateddiffuse of pbrt-v4
    const Material mirror = pbrt_material("Material \"mirror\" \"rgb Kr\" [.8 .8 .8]");
    CHECK(mirror.metallic == 1);
    CHECK(mirror.base_color == grey(0.8f));
    // F82 is Kr at 82 degrees too.
    CHECK(mirror.specular_color.r * (0.8f + 0.2f * pow(6.0f / 7, 5)) == doctest::Approx(0.8));
    const Material blind =
        pbrt_material("Material \"uber\" \"rgb Kd\" [.6 .5 .4] \"rgb Ks\" [0 0 0] \"rgb opacity\" [.7 .7 .7]");
    CHECK(blind.kind == MaterialKind::Diffuse);
    CHECK(blind.alpha == doctest::Approx(0.7));
    const Material lacquer =
        pbrt_material("Material \"uber\" \"rgb Kd\" [.6 .5 .4] \"rgb Ks\" [0 0 0] \"rgb Kr\" [.5 .5 .5]");
    CHECK(lacquer.roughness == 0);
    CHECK(lacquer.specular_weight == 0.5f);
    CHECK(lacquer.coat_weight == 0);
    const Material two =
        pbrt_material("Material \"uber\" \"rgb Ks\" [.2 .2 .2] \"rgb Kr\" [.5 .5 .5] \"float roughness\" .3");
    CHECK(two.coat_weight == 0.5f);
    CHECK(two.coat_roughness == 0);
    CHECK(two.coat_ior == 1.5f);
    CHECK(two.roughness > 0);
    const Material clear =
        pbrt_material("Material \"uber\" \"rgb Kd\" [0 0 0] \"rgb Ks\" [0 0 0] \"rgb Kt\" [.8 .6 .4]");
    CHECK(clear.is_solid());
    CHECK(clear.transmission_weight == 1);
    CHECK(clear.base_color == Rgb{0.8f, 0.6f, 0.4f});
    const Material cloudy =
        pbrt_material("Material \"uber\" \"rgb Kd\" [.3 .3 .3] \"rgb Ks\" [0 0 0] \"rgb Kt\" [.6 .6 .6]");
    CHECK(cloudy.transmission_weight * cloudy.base_color.r == doctest::Approx(0.6));
    CHECK((1 - cloudy.transmission_weight) * cloudy.base_color.r == doctest::Approx(0.3));
    const Material leaf = pbrt_material("Material \"translucent\" \"rgb Kd\" [.8 .8 .8] \"rgb Ks\" [0 0 0]");
    CHECK((1 - leaf.diffuse_transmission_weight) * leaf.base_color.r == doctest::Approx(0.4));
    CHECK(leaf.diffuse_transmission_weight * leaf.diffuse_transmission_color.r == doctest::Approx(0.4));
    CHECK(load_pbrt_material("Material \"fourier\" \"string bsdffile\" \"a.bsdf\"").messages.left_out().size() == 1);
}

TEST_CASE("pbrt: images have their encoding, mapping and v upwards") {
    const std::string head = "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.exr\" ";
    const std::string use = "\nMaterial \"diffuse\" \"texture reflectance\" \"t\"";
    const OneMaterial plain = load_pbrt_material(head + use);
    CHECK(plain.messages.left_out().empty());
    CHECK(plain.material.base_color == grey(1));
    CHECK(plain.material.base_color_texture.is_srgb);
    CHECK(pbrt_texel(plain.scene, plain.material.base_color_texture, 0.2f, 0.5f) == 0.25f);
    const Material mapped =
        load_pbrt_material(head +
                           "\"float uscale\" 2 \"float vscale\" 3 \"float udelta\" .25 \"float vdelta\" "
                           ".5 \"string wrap\" \"clamp\" \"string encoding\" \"linear\"" +
                           use)
            .material;
    const TextureRef& ref = mapped.base_color_texture;
    CHECK_FALSE(ref.is_srgb);
    CHECK(ref.wrap_s == Wrap::ClampToEdge);
    CHECK(ref.m00 == 2);
    CHECK(ref.m02 == 0.25f);
    // A point at v = 0.1 has 1 - 0.1 in the mesh, and is 1 - (3 * 0.1 + 0.5) below the picture's upper edge.
    CHECK(ref.m11 * (1 - 0.1f) + ref.m12 == doctest::Approx(0.2));
    CHECK(load_pbrt_material(head + "\"float scale\" .5" + use).material.base_color == grey(0.5f));
    const OneMaterial bright = load_pbrt_material(head + "\"float scale\" 1.5" + use);
    CHECK(pbrt_texel(bright.scene, bright.material.base_color_texture, 0.8f, 0.5f) == doctest::Approx(0.75));
    const OneMaterial inverted = load_pbrt_material(head + "\"bool invert\" true" + use);
    CHECK(pbrt_texel(inverted.scene, inverted.material.base_color_texture, 0.2f, 0.5f) == doctest::Approx(0.75));
    CHECK(inverted.scene.images.size() == 1);
    const OneMaterial gamma = load_pbrt_material(head + "\"string encoding\" \"gamma 2\"" + use);
    CHECK(pbrt_texel(gamma.scene, gamma.material.base_color_texture, 0.8f, 0.5f) == doctest::Approx(0.25));
    const OneMaterial missing =
        load_pbrt_material("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"none.png\"" + use);
    CHECK(missing.messages.left_out().size() == 1);
    CHECK(missing.material.base_color == grey(0.5f));
    const OneMaterial unknown = load_pbrt_material(
        "Texture \"wood\" \"spectrum\" \"constant\"\nMaterial \"diffuse\" \"texture reflectance\" \"wod\"");
    REQUIRE(unknown.messages.left_out().size() == 1);
    CHECK(unknown.messages.left_out()[0].find("\"wood\"") != std::string::npos);
}

TEST_CASE("pbrt: roughness from an image is converted texel by texel") {
    const OneMaterial read =
        load_pbrt_material("Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"a.exr\"\n"
                           "Material \"conductor\" \"texture roughness\" \"t\" \"bool remaproughness\" false");
    CHECK(read.material.roughness == 1);
    CHECK(pbrt_texel(read.scene, read.material.roughness_texture, 0.2f, 0.5f) == doctest::Approx(0.5));
}

TEST_CASE("pbrt: constants, products, mixtures and checkerboards") {
    const auto color = [](const std::string& textures) {
        return pbrt_material(textures + "\nMaterial \"diffuse\" \"texture reflectance\" \"t\"").base_color;
    };
    CHECK(color("Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [.1 .2 .3]") == Rgb{0.1f, 0.2f, 0.3f});
    CHECK(color("Texture \"t\" \"spectrum\" \"scale\" \"rgb tex\" [.5 .5 .5] \"float scale\" .5") == grey(0.25f));
    CHECK(color("Texture \"t\" \"color\" \"scale\" \"rgb tex1\" [.5 .5 .5] \"rgb tex2\" [.5 .5 .5]") == grey(0.25f));
    CHECK(color("Texture \"t\" \"spectrum\" \"mix\" \"rgb tex1\" [0 0 0] \"rgb tex2\" [1 1 1] \"float amount\" .25") ==
          grey(0.25f));
    const OneMaterial board =
        load_pbrt_material("Texture \"t\" \"spectrum\" \"checkerboard\" \"rgb tex1\" [.8 .8 .8] \"rgb "
                           "tex2\" [.2 .2 .2] \"float uscale\" 4 \"float vscale\" 2\n"
                           "Material \"diffuse\" \"texture reflectance\" \"t\"");
    CHECK(board.messages.left_out().empty());
    const TextureRef& ref = board.material.base_color_texture;
    CHECK(ref.filter == TextureFilter::Nearest);
    for (int row = 0; row < 2; ++row) {
        for (int column = 0; column < 4; ++column) {
            const float u = (float(column) + 0.3f) / 4, v = (float(row) + 0.3f) / 2;
            CHECK(pbrt_texel(board.scene, ref, u, v) == ((row + column) % 2 == 0 ? 0.8f : 0.2f));
        }
    }
    const OneMaterial noise = load_pbrt_material(
        "Texture \"t\" \"spectrum\" \"fbm\" \"integer octaves\" 4\nMaterial \"diffuse\" \"texture reflectance\" \"t\"");
    CHECK(noise.messages.left_out().size() == 1);
    CHECK(noise.material.base_color == grey(0.5f));
}

TEST_CASE("pbrt: alpha of a shape, bumps and normal maps") {
    const std::string head = "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"a.exr\"\n";
    Messages messages;
    const fs::path folder = test::scratch_folder();
    write_image(folder / "a.exr", Image{.width = 2, .height = 1, .channels = 3, .pixels = {0, 0, 0, 1, 1, 1}});
    const Scene scene = read_scene(
        test::write_text(folder / "scene.pbrt",
                         head + "WorldBegin\n" + head +
                             "Shape \"sphere\" \"float alpha\" .5\nShape \"sphere\" \"texture alpha\" \"t\"\n"
                             "Attribute \"shape\" \"float alpha\" 0.25\nShape \"sphere\"\n"
                             "Material \"diffuse\" \"texture displacement\" \"t\"\n" +
                             kFace + "Material \"diffuse\" \"string normalmap\" \"a.exr\"\n" + kFace),
        {}, messages);
    CHECK(messages.left_out().empty());
    REQUIRE(scene.instances.size() == 5);
    const auto of = [&](std::size_t i) -> const Material& { return scene.materials[scene.instances[i].material]; };
    CHECK(of(0).alpha == 0.5f);
    CHECK(of(0).alpha_mode == AlphaMode::Blend);
    CHECK(of(1).alpha == 1);
    CHECK(of(1).alpha_texture.has_image());
    CHECK(of(2).alpha == 0.25f);
    CHECK(of(3).normal_texture.has_image());
    // The picture is 2 m wide and 2 m high for two pixels by one; heights are metres, kBumpHeight is 0.02 of 2 pixels.
    CHECK(of(3).normal_scale == doctest::Approx(std::sqrt(2.0) / 2 / (0.02 * 2)));
    CHECK(of(3).normal_texture.image != of(4).normal_texture.image);
    CHECK(of(4).normal_scale == 1);
    CHECK_FALSE(of(4).normal_texture.is_srgb);
}

TEST_CASE("pbrt: a texture that is defined again has its new value as alpha from there on") {
    const OneMaterial read = load_pbrt_material("Texture \"t\" \"float\" \"constant\" \"float value\" 0.5\n"
                                                "Shape \"sphere\" \"texture alpha\" \"t\"\n"
                                                "Texture \"t\" \"float\" \"constant\" \"float value\" 0.25\n"
                                                "Shape \"sphere\" \"texture alpha\" \"t\"\n");
    REQUIRE(read.scene.instances.size() == 3);
    CHECK(read.scene.materials[read.scene.instances[0].material].alpha == 0.5f);
    CHECK(read.scene.materials[read.scene.instances[1].material].alpha == 0.25f);
}

TEST_CASE("pbrt: the value of a missing picture is inverted as its texels would be") {
    const auto color = [](const char* more) {
        return load_pbrt_material(
                   std::string("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"no.png\" ") + more +
                   " Material \"diffuse\" \"texture reflectance\" \"t\"")
            .material.base_color;
    };
    CHECK(color("") == grey(0.5f));
    CHECK(color("\"bool invert\" true") == grey(0.5f));
    CHECK(color("\"bool invert\" true \"float scale\" 0.5") == grey(0.75f));
}

TEST_CASE("pbrt: numbers of a material that fit no float are kept within their range, and cost no more") {
    const OneMaterial read = load_pbrt_material("Material \"disney\"\n\"float metallic\" 1e300");
    CHECK(read.material.metallic == 1);
    CHECK(read.messages.left_out().size() == 1);
    const OneMaterial mapped = load_pbrt_material(
        "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.exr\" \"float uscale\" 1e30\n"
        "Material \"diffuse\" \"texture reflectance\" \"t\"");
    CHECK(mapped.material.base_color_texture.m00 == 1);
    CHECK(mapped.messages.left_out().size() == 1);
}

TEST_CASE("pbrt: triangles without texture coordinates have those of pbrt under a texture") {
    const std::string flat =
        "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0] \"integer indices\" [0 1 2 0 2 3]\n";
    const Scene scene = load_pbrt_material("Texture \"t\" \"spectrum\" \"checkerboard\"\n" + flat +
                                           "Material \"diffuse\" \"texture reflectance\" \"t\"\n" + flat +
                                           "ReverseOrientation\n" + flat)
                            .scene;
    CHECK(scene.meshes[0].uv[0].empty());
    CHECK(scene.meshes[0].positions.size() == 4);
    REQUIRE(scene.meshes[1].uv[0].size() == 6);
    CHECK(scene.meshes[1].uv[0][4] == Vec2{1, 1});
    CHECK(scene.meshes[1].uv[0][5] == Vec2{1, 0});
    CHECK(scene.meshes[1].positions[5] == Vec3{0, 1, 0});
    REQUIRE(scene.meshes.size() == 4); // the last one is kFace; corners of the third are turned
    REQUIRE(scene.meshes[2].uv[0].size() == 6);
    for (std::size_t i = 0; i < 6; ++i) {
        const std::size_t same = i % 3 == 0 ? i : i - i % 3 + (3 - i % 3);
        CHECK(scene.meshes[2].positions[i] == scene.meshes[1].positions[same]);
        CHECK(scene.meshes[2].uv[0][i] == scene.meshes[1].uv[0][same]);
    }
}

TEST_CASE("pbrt: a substrate whose coat reflects all light that arrives inside has no colour that is not a number") {
    for (const std::string_view diffuse : {"1", "0.5"}) {
        const Rgb color = load_pbrt_material(fmt::format("Material \"substrate\" \"rgb Kd\" [{0} {0} {0}] "
                                                         "\"rgb Ks\" [.8 .8 .8]",
                                                         diffuse),
                                             "WorldEnd\n")
                              .material.base_color;
        CHECK(color.r >= 0);
        CHECK(color.r <= 1);
        if (diffuse == "1") CHECK(color.r == 1);
    }
}

TEST_CASE("pbrt: colours of another colour space are converted") {
    const Rgb green =
        pbrt_material("ColorSpace \"rec2020\" Material \"diffuse\" \"rgb reflectance\" [.5 .5 .5]").base_color;
    CHECK(green.g == doctest::Approx(0.5).epsilon(1e-3));
    const Rgb pure =
        pbrt_material("ColorSpace \"dci-p3\" Material \"diffuse\" \"rgb reflectance\" [.2 .5 .2]").base_color;
    CHECK(pure.r < 0.19f);
    CHECK(pure.g > 0.5f);
}
