// Mixtures of materials of pbrt and Mitsuba: one material, or surfaces in one place. What they show is tested in
// tests/statistical/mixed_surfaces_test.cpp. Coloured pictures that are weights and other numbers are tested here too.

#include <cmath>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "formats/read_scene.h"
#include "image/srgb.h"
#include "image/write_image.h"
#include "image/write_png.h"
#include "math/portable_math.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace {

struct MixtureRead {
    Scene scene;
    Material material;
    Messages messages;
};

/// Reads a face with a material of pbrt, or a square with a BSDF of Mitsuba, in a folder with the picture a.exr (two
/// pixels of 0.25 and 0.5).
MixtureRead load_mixture(const std::string& text, const std::string& end = "") {
    const std::filesystem::path folder = test::scratch_folder();
    write_image(folder / "a.exr",
                Image{.width = 2, .height = 1, .channels = 3, .pixels = {0.25f, 0.25f, 0.25f, 0.5f, 0.5f, 0.5f}});
    const bool is_xml = text.starts_with("<");
    const std::string scene =
        is_xml ? fmt::format("<scene version=\"3.0.0\"><shape type=\"rectangle\">{}</shape></scene>", text)
               : "WorldBegin\n" + text +
                     "\nShape \"trianglemesh\" \"point3 P\" [0 0 0 2 0 0 0 2 0] \"point2 uv\" [0 0 1 0 0 1] \"integer "
                     "indices\" [0 1 2]\n" +
                     end;
    MixtureRead read;
    read.scene = read_scene(test::write_text(folder / (is_xml ? "scene.xml" : "scene.pbrt"), scene), {}, read.messages);
    if (!read.scene.instances.empty()) read.material = read.scene.materials[read.scene.instances[0].material];
    return read;
}

Material mixture_material(const std::string& text, const std::string& end = "") {
    const MixtureRead read = load_mixture(text, end);
    CHECK(read.messages.left_out() == std::vector<std::string>{});
    return read.material;
}

/// The nearest pixel of a texture's image at a u.
float mixture_texel(const Scene& scene, const TextureRef& ref, float u, float) {
    const Image& image = scene.images.at(static_cast<std::size_t>(ref.image)).rgba_float;
    return image.pixels.at(4 * static_cast<std::size_t>(u * static_cast<float>(image.width)));
}

/// The materials of the shapes in their order, each with its alpha.
std::string stack_of(const Scene& scene) {
    std::string text;
    for (const Instance& instance : scene.instances) {
        const Material& m = scene.materials[instance.material];
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", m.name,
                            m.alpha_texture.has_image() ? "image" : fmt::format("{:.6g}", m.alpha));
    }
    return text;
}

constexpr Rgb kFirst = {0.2f, 0.6f, 0.8f}, kSecond = {0.9f, 0.1f, 0.35f};

struct GreyRead {
    Scene scene;
    Material material; // the first shape has it
};

float mean_of_texel(Rgb c) { return (c.r + c.g + c.b) / 3; }

/// Reads a scene in a folder with the pictures c.exr and c.png, of two coloured pixels, and g.exr of their means.
GreyRead read_beside_colors(const std::string& name, const std::string& text) {
    const std::filesystem::path folder = test::scratch_folder();
    const Image colors = {.width = 2,
                          .height = 1,
                          .channels = 3,
                          .pixels = {kFirst.r, kFirst.g, kFirst.b, kSecond.r, kSecond.g, kSecond.b}};
    write_image(folder / "c.exr", colors);
    const float a = mean_of_texel(kFirst), b = mean_of_texel(kSecond);
    write_image(folder / "g.exr", Image{.width = 2, .height = 1, .channels = 3, .pixels = {a, a, a, b, b, b}});
    write_png(folder / "c.png", Rgba8Image{.width = 2, .height = 1, .pixels = {51, 153, 204, 255, 230, 26, 89, 255}});
    Messages messages;
    GreyRead read;
    read.scene = read_scene(test::write_text(folder / name, text), {}, messages);
    CHECK(messages.left_out() == std::vector<std::string>{});
    read.material = read.scene.materials.at(read.scene.instances.at(0).material);
    return read;
}
GreyRead read_pbrt_colors(const std::string& text, const std::string& shape = "", const std::string& end = "") {
    const std::string face = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 2 0 0 0 2 0] \"point2 uv\" [0 0 1 0 0 1] "
                             "\"integer indices\" [0 1 2] ";
    return read_beside_colors("scene.pbrt",
                              "WorldBegin\nTexture \"t\" \"float\" \"imagemap\" \"string filename\" \"c.exr\"\n"
                              "Texture \"p\" \"float\" \"imagemap\" \"string filename\" \"c.png\"\n" +
                                  text + "\n" + face + shape + "\n" + end);
}
GreyRead read_mitsuba_colors(const std::string& bsdf, const std::string& version = "3.0.0") {
    return read_beside_colors("scene.xml", fmt::format("<scene version=\"{}\"><shape type=\"rectangle\">{}</shape>"
                                                       "</scene>",
                                                       version, bsdf));
}

/// Returns the first or second texel of a texture, which are floats.
Rgb grey_texel(const GreyRead& read, const TextureRef& ref, std::size_t i) {
    const std::vector<float>& p = read.scene.images.at(static_cast<std::size_t>(ref.image)).rgba_float.pixels;
    return {p.at(4 * i), p.at(4 * i + 1), p.at(4 * i + 2)};
}
void check_texel(const GreyRead& read, const TextureRef& ref, std::size_t i, Rgb wanted) {
    const Rgb texel = grey_texel(read, ref, i);
    CHECK(texel.r == doctest::Approx(wanted.r).epsilon(2e-3));
    CHECK(texel.g == doctest::Approx(wanted.g).epsilon(2e-3));
    CHECK(texel.b == doctest::Approx(wanted.b).epsilon(2e-3));
}

const std::string kBitmap = "<texture name=\"{}\" type=\"bitmap\"><string name=\"filename\" value=\"c.exr\"/>"
                            "<boolean name=\"raw\" value=\"true\"/></texture>";
std::string mitsuba_bitmap(const std::string& name) { return fmt::format(fmt::runtime(kBitmap), name); }
const std::string kTwo = "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\".8 .2 .2\"/></bsdf>"
                         "<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\".2 .2 .6\"/></bsdf>";

} // namespace

TEST_CASE("pbrt: mixtures are exact where one material can be both") {
    const std::string two = "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [.2 .2 .2]\n"
                            "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"rgb reflectance\" [.6 .6 .6]\n"
                            "MakeNamedMaterial \"c\" \"string type\" \"conductor\"\n";
    CHECK(mixture_material(two + "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" .25")
              .base_color.r == doctest::Approx(0.3));
    // The amount is that of the first in pbrt-v3.
    CHECK(
        mixture_material(
            two +
                "Material \"mix\" \"string namedmaterial1\" \"a\" \"string namedmaterial2\" \"b\" \"float amount\" .25",
            "WorldEnd\n")
            .base_color.r == doctest::Approx(0.5));
    const Material hole =
        mixture_material(two + "Material \"mix\" \"string materials\" [\"interface\" \"b\"] \"float amount\" .75");
    CHECK(hole.alpha == 0.75f);
    CHECK(hole.alpha_mode == AlphaMode::Blend);
    CHECK(mixture_material(two + "Material \"mix\" \"string materials\" [\"b\" \"interface\"] \"float amount\" .75")
              .alpha == 0.25f);
    // Unlike materials are surfaces in one place, of which the upper ones have an alpha.
    const MixtureRead other =
        load_mixture(two + "Material \"mix\" \"string materials\" [\"a\" \"c\"] \"float amount\" .75");
    CHECK(other.messages.left_out().empty());
    CHECK(stack_of(other.scene) == "a 0.25, c 1");
    REQUIRE(other.scene.instances.size() == 2);
    CHECK(other.scene.instances[0].mesh == other.scene.instances[1].mesh);
    const std::string nested = two +
                               "MakeNamedMaterial \"ac\" \"string type\" \"mix\" \"string materials\" [\"a\" \"c\"]\n"
                               "MakeNamedMaterial \"d\" \"string type\" \"coateddiffuse\"\n";
    CHECK(stack_of(load_mixture(nested + "Material \"mix\" \"string materials\" [\"ac\" \"d\"] \"float amount\" "
                                         ".5")
                       .scene) == "a 0.25, c 0.333333, d 1");
    CHECK(stack_of(load_mixture(nested + "Material \"mix\" \"string materials\" [\"ac\" \"interface\"] \"float "
                                         "amount\" .5")
                       .scene) == "a 0.25, c 0.333333");
    CHECK(stack_of(load_mixture(nested + "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"a.exr\" "
                                         "Material \"mix\" \"string materials\" [\"ac\" \"d\"] \"texture "
                                         "amount\" \"t\"")
                       .scene) == "d image, a 0.5, c 1");
    // A light is sampled on each surface, so a shape that emits keeps one.
    const MixtureRead lamp = load_mixture(two + "AreaLightSource \"diffuse\" Material \"mix\" \"string materials\" "
                                                "[\"a\" \"c\"] \"float amount\" .75");
    CHECK(lamp.messages.left_out().size() == 1);
    CHECK(stack_of(lamp.scene) == "c 1");
    // Two bodies of glass in one place would each enclose the other.
    const MixtureRead bodies = load_mixture("MakeNamedMaterial \"e\" \"string type\" \"dielectric\"\n"
                                            "MakeNamedMaterial \"f\" \"string type\" \"dielectric\" \"float eta\" 1.2\n"
                                            "Material \"mix\" \"string materials\" [\"e\" \"f\"] \"float amount\" .75");
    CHECK(bodies.messages.left_out().size() == 1);
    CHECK(stack_of(bodies.scene) == "mix 1");
    const MixtureRead none = load_mixture("Material \"mix\" \"string materials\" [\"a\"]");
    CHECK(none.messages.left_out().size() == 1);
    CHECK(none.material.base_color == grey(0.5f));
    const MixtureRead masked =
        load_mixture(two + "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"a.exr\"\n"
                           "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"texture amount\" \"t\"");
    CHECK(mixture_texel(masked.scene, masked.material.base_color_texture, 0.2f, 0.5f) == doctest::Approx(0.3));
    CHECK(mixture_texel(masked.scene, masked.material.base_color_texture, 0.8f, 0.5f) == doctest::Approx(0.4));
}

TEST_CASE("pbrt: mixtures in which one number differs are one material") {
    const auto mixed = [](const char* first, const char* second, const char* amount) {
        const MixtureRead read = load_mixture(
            fmt::format("Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"a.exr\" MakeNamedMaterial \"a\" "
                        "\"string type\" {}\nMakeNamedMaterial \"b\" \"string type\" {}\nMaterial \"mix\" \"string "
                        "materials\" [\"a\" \"b\"] {}",
                        first, second, amount));
        CHECK(read.messages.left_out() == std::vector<std::string>{});
        CHECK(read.scene.instances.size() == 1);
        return read;
    };
    const char *const bare = "\"conductor\" \"spectrum eta\" \"metal-Cu-eta\" \"spectrum k\" \"metal-Cu-k\"",
                      *const coated = "\"coatedconductor\" \"float conductor.roughness\" 0",
                      *const leaf = "\"diffusetransmission\" \"rgb reflectance\" [.1 .4 .1] \"rgb transmittance\" "
                                    "[.3 .6 .1]";
    CHECK(mixed(bare, coated, "\"float amount\" .25").material.coat_weight == 0.25f);
    CHECK(mixed(coated, bare, "\"float amount\" .25").material.coat_weight == 0.75f);
    const MixtureRead placed = mixed(bare, coated, "\"texture amount\" \"t\"");
    CHECK(placed.material.coat_weight == 1);
    CHECK(mixture_texel(placed.scene, placed.material.coat_texture, 0.8f, 0.5f) == 0.5f);
    const Material sheet = mixed(leaf, "\"diffuse\" \"rgb reflectance\" [.5 0 .5]", "\"float amount\" .5").material;
    const float far = sheet.diffuse_transmission_weight;
    CHECK((1 - far) * sheet.base_color.r == doctest::Approx(0.3));
    CHECK((1 - far) * sheet.base_color.g == doctest::Approx(0.2));
    CHECK(far * sheet.diffuse_transmission_color.g == doctest::Approx(0.3));
    CHECK(far * sheet.diffuse_transmission_color.b == doctest::Approx(0.05));
    const MixtureRead veil = mixed("\"diffuse\" \"rgb reflectance\" [.5 0 .5]",
                                   "\"diffusetransmission\" \"rgb reflectance\" [0 0 0]", "\"texture amount\" \"t\"");
    CHECK(veil.material.base_color == Rgb{0.5f, 0, 0.5f});
    CHECK(veil.material.diffuse_transmission_color == grey(0.25f));
    CHECK(mixture_texel(veil.scene, veil.material.diffuse_transmission_texture, 0.8f, 0.5f) == 0.5f);
}

TEST_CASE("pbrt: parts whose heights differ stay apart, and equal ones keep the colours of faces") {
    const std::string heights = "Texture \"h\" \"float\" \"checkerboard\" \"float tex1\" 0 \"float tex2\" .1\n"
                                "Texture \"i\" \"float\" \"checkerboard\" \"float tex1\" 0 \"float tex2\" .2\n"
                                "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"texture displacement\" \"h\"\n"
                                "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"texture displacement\" \"i\"\n";
    CHECK(stack_of(load_mixture(heights + "Material \"mix\" \"string materials\" [\"a\" \"b\"]").scene) ==
          "a 0.5, b 1");
    const std::string faces =
        "Texture \"t\" \"spectrum\" \"directionmix\" \"rgb tex1\" [.8 .4 0] \"rgb tex2\" [0 .2 .4]\n"
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"texture reflectance\" \"t\"\n";
    // Equal parts keep the colours of faces.
    CHECK_FALSE(
        load_mixture(faces + "Material \"mix\" \"string materials\" [\"a\" \"a\"]").scene.meshes.at(0).colors.empty());
}

TEST_CASE("pbrt: a directionmix is the colour of each face") {
    const auto color_of = [](const char* before, const char* between) {
        const MixtureRead read = load_mixture(
            fmt::format("{} Texture \"t\" \"spectrum\" \"directionmix\" \"rgb tex1\" [.8 .4 0] \"rgb tex2\" [0 .2 .4] "
                        "\"vector3 dir\" [0 3 4]\nIdentity {} Material \"diffuse\" \"texture reflectance\" \"t\"",
                        before, between));
        CHECK(read.messages.left_out() == std::vector<std::string>{});
        const Vec4 color = read.scene.meshes.at(0).colors.at(1);
        CHECK(read.material.base_color == grey(1));
        return Rgb{color.x, color.y, color.z};
    };
    const auto check = [](Rgb color, Rgb wanted) {
        CHECK(color.r == doctest::Approx(wanted.r).epsilon(1e-5));
        CHECK(color.g == doctest::Approx(wanted.g).epsilon(1e-5));
        CHECK(color.b == doctest::Approx(wanted.b).epsilon(1e-5));
    };
    check(color_of("", ""), {0.64f, 0.36f, 0.08f}); // the face is across z
    check(color_of("", "Rotate 90 1 0 0"), {0.48f, 0.32f, 0.16f});
    check(color_of("Rotate 90 0 1 0", ""), {0, 0.2f, 0.4f}); // the direction turns with the texture
    check(color_of("", "Scale 1 1 -5"), {0.64f, 0.36f, 0.08f});
    const MixtureRead rough = load_mixture(
        "Texture \"t\" \"float\" \"directionmix\" \"float tex1\" .2 \"float tex2\" .4 Material \"conductor\" "
        "\"texture roughness\" \"t\" \"bool remaproughness\" false");
    CHECK(rough.messages.left_out().size() == 1);
    CHECK(rough.material.roughness == doctest::Approx(std::sqrt(0.3)));
}

TEST_CASE("mitsuba: parts that differ in more than a number are surfaces in one place") {
    const auto bsdf_of = [](const std::string& type, const std::string& inner = "") {
        return fmt::format("<bsdf type=\"{}\">{}</bsdf>", type, inner);
    };
    const auto number_of = [](const char* name, double value) {
        return fmt::format("<float name=\"{}\" value=\"{}\"/>", name, value);
    };
    const auto bitmap_of = [](const char* name) {
        return fmt::format("<texture name=\"{}\" type=\"bitmap\"><string name=\"filename\" value=\"a.exr\"/></texture>",
                           name);
    };
    const std::string red = bsdf_of("diffuse", "<rgb name=\"reflectance\" value=\"1 0 0\"/>"),
                      blue = bsdf_of("diffuse");
    const auto alphas_of = [](const std::string& bsdf) {
        const MixtureRead read = load_mixture(bsdf);
        CHECK(read.messages.left_out() == std::vector<std::string>{});
        std::vector<float> alphas;
        for (const Instance& instance : read.scene.instances)
            alphas.push_back(read.scene.materials[instance.material].alpha);
        return alphas;
    };
    const std::string thin = bsdf_of("mask", number_of("opacity", 0.25) + blue);
    const auto blend_of = [&](double weight, const std::string& parts) {
        return bsdf_of("blendbsdf", number_of("weight", weight) + parts);
    };
    CHECK(alphas_of(blend_of(0.25, red + bsdf_of("dielectric"))) == std::vector<float>{0.75f, 1});
    CHECK(alphas_of(blend_of(0.5, red + thin)) == std::vector<float>{0.5f, 0.25f}); // 0.375 pass both
    CHECK(alphas_of(bsdf_of("mask", number_of("opacity", 0.5) + blend_of(0.5, red + bsdf_of("conductor")))) ==
          std::vector<float>{0.25f, 1 / 3.0f});
    const MixtureRead placed = load_mixture(bsdf_of("blendbsdf", bitmap_of("weight") + red + bsdf_of("conductor")));
    CHECK(placed.messages.left_out() == std::vector<std::string>{});
    REQUIRE(placed.scene.instances.size() == 2);
    CHECK(placed.material.kind == MaterialKind::Conductor);
    CHECK(mixture_texel(placed.scene, placed.material.alpha_texture, 0.9f, 0.1f) == 0.5f);
    const MixtureRead unlike = load_mixture(bsdf_of(
        "blendbsdf", bitmap_of("weight") + thin +
                         bsdf_of("mask", bitmap_of("opacity") + bsdf_of("conductor")))); // a product of textures
    CHECK(unlike.messages.left_out().size() == 1);
    const std::string placed_parts = bsdf_of("blendbsdf", bitmap_of("weight") + red + bsdf_of("conductor"));
    CHECK(load_mixture(bsdf_of("mask", number_of("opacity", 0.5) + placed_parts)).messages.left_out().size() == 1);
    CHECK(load_mixture(bsdf_of("mask", bitmap_of("opacity") + placed_parts)).messages.left_out().size() == 1);
}

TEST_CASE("pbrt: where a number stands, a coloured picture is its mean, in version 3 its encoded luminance") {
    const std::string metal = "Material \"conductor\" \"bool remaproughness\" false \"texture roughness\" ";
    const GreyRead rough = read_pbrt_colors(metal + "\"t\"");
    check_texel(rough, rough.material.roughness_texture, 0, grey(std::sqrt(mean_of_texel(kFirst))));
    check_texel(rough, rough.material.roughness_texture, 1, grey(std::sqrt(mean_of_texel(kSecond))));
    const GreyRead old = read_pbrt_colors(metal + "\"t\"", "", "WorldEnd\n");
    check_texel(old, old.material.roughness_texture, 0, grey(std::sqrt(luminance(kFirst))));
    const GreyRead decoded = read_pbrt_colors(metal + "\"p\"");
    const auto linear = [](Rgb c) { return Rgb{srgb_decode(c.r), srgb_decode(c.g), srgb_decode(c.b)}; };
    check_texel(decoded, decoded.material.roughness_texture, 0, grey(std::sqrt(mean_of_texel(linear(kFirst)))));
    const GreyRead decoded_later = read_pbrt_colors(metal + "\"p\"", "", "WorldEnd\n");
    check_texel(decoded_later, decoded_later.material.roughness_texture, 0,
                grey(std::sqrt(srgb_decode(luminance(kFirst)))));
    const GreyRead cut = read_pbrt_colors("Material \"diffuse\"", "\"texture alpha\" \"t\"");
    check_texel(cut, cut.material.alpha_texture, 1, grey(mean_of_texel(kSecond)));
}

TEST_CASE("pbrt: a coloured picture mixes all channels by its mean, and each by its own in version 3") {
    const std::string two = "MakeNamedMaterial \"a\" \"string type\" \"{0}\" \"rgb {1}\" [.8 .2 .2]\n"
                            "MakeNamedMaterial \"b\" \"string type\" \"{0}\" \"rgb {1}\" [.2 .2 .6]\n";
    const float share = mean_of_texel(kFirst);
    const GreyRead mixed = read_pbrt_colors(fmt::format(fmt::runtime(two), "diffuse", "reflectance") +
                                            "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"texture amount\" "
                                            "\"t\"");
    check_texel(mixed, mixed.material.base_color_texture, 0, lerp(Rgb{0.8f, 0.2f, 0.2f}, Rgb{0.2f, 0.2f, 0.6f}, share));
    const GreyRead old = read_pbrt_colors(
        "Texture \"c\" \"spectrum\" \"imagemap\" \"string filename\" \"c.exr\"\n" +
            fmt::format(fmt::runtime(two), "matte", "Kd") +
            "Material \"mix\" \"string namedmaterial1\" \"b\" \"string namedmaterial2\" \"a\" \"texture amount\" \"c\"",
        "", "WorldEnd\n");
    check_texel(old, old.material.base_color_texture, 0, {0.8f - 0.6f * kFirst.r, 0.2f, 0.2f + 0.4f * kFirst.b});
    const GreyRead veil = read_pbrt_colors("Texture \"c\" \"spectrum\" \"imagemap\" \"string filename\" \"c.exr\"\n"
                                           "Material \"uber\" \"texture opacity\" \"c\"");
    check_texel(veil, veil.material.alpha_texture, 0, grey(share));
    // A spectrum that a picture mixes by a number keeps its colours.
    const GreyRead between =
        read_pbrt_colors("Texture \"m\" \"spectrum\" \"mix\" \"texture amount\" \"t\" \"rgb tex1\" "
                         "[.8 .2 .2] \"rgb tex2\" [.2 .2 .6]\n"
                         "Material \"diffuse\" \"texture reflectance\" \"m\"");
    check_texel(between, between.material.base_color_texture, 0,
                lerp(Rgb{0.8f, 0.2f, 0.2f}, Rgb{0.2f, 0.2f, 0.6f}, share));
}

TEST_CASE("pbrt: bumps have the mean of a coloured picture as heights") {
    const auto normals_of = [](const std::string& picture) {
        const GreyRead read = read_pbrt_colors(picture + "Material \"diffuse\" \"texture displacement\" \"h\"");
        return grey_texel(read, read.material.normal_texture, 0);
    };
    const Rgb coloured = normals_of("Texture \"h\" \"float\" \"imagemap\" \"string filename\" \"c.exr\"\n");
    const Rgb of_means = normals_of("Texture \"h\" \"float\" \"imagemap\" \"string filename\" \"g.exr\"\n");
    CHECK(coloured.r == doctest::Approx(of_means.r));
    CHECK(coloured.b == doctest::Approx(of_means.b));
}

TEST_CASE("mitsuba: where a number stands, a bitmap is its luminance, in 0.6 its mean, and a colour its mean") {
    const std::string mask = "<bsdf type=\"mask\">" + mitsuba_bitmap("opacity") + "<bsdf type=\"diffuse\"/></bsdf>";
    const GreyRead masked = read_mitsuba_colors(mask), old = read_mitsuba_colors(mask, "0.6.0");
    check_texel(masked, masked.material.alpha_texture, 0, grey(luminance(kFirst)));
    check_texel(masked, masked.material.alpha_texture, 1, grey(luminance(kSecond)));
    check_texel(old, old.material.alpha_texture, 1, grey(mean_of_texel(kSecond)));
    const GreyRead rough = read_mitsuba_colors("<bsdf type=\"roughconductor\">" + mitsuba_bitmap("alpha") + "</bsdf>");
    check_texel(rough, rough.material.roughness_texture, 0, grey(std::sqrt(luminance(kFirst))));
    const GreyRead blended =
        read_mitsuba_colors("<bsdf type=\"blendbsdf\">" + mitsuba_bitmap("weight") + kTwo + "</bsdf>");
    check_texel(blended, blended.material.base_color_texture, 1,
                lerp(Rgb{0.8f, 0.2f, 0.2f}, Rgb{0.2f, 0.2f, 0.6f}, luminance(kSecond)));
    const GreyRead constant = read_mitsuba_colors(
        "<bsdf type=\"mask\"><rgb name=\"opacity\" value=\".9 .2 .1\"/><bsdf type=\"diffuse\"/></bsdf>");
    CHECK(constant.material.alpha == doctest::Approx(0.4));
    const GreyRead colour = read_mitsuba_colors("<bsdf type=\"diffuse\">" + mitsuba_bitmap("reflectance") + "</bsdf>");
    check_texel(colour, colour.material.base_color_texture, 1, kSecond);
}

TEST_CASE("mitsuba: the checks of a checkerboard of numbers are exchanged, but not in 0.6") {
    const auto opacity = [](const std::string& version) {
        const GreyRead read = read_mitsuba_colors("<bsdf type=\"mask\"><texture name=\"opacity\" type=\"checkerboard\">"
                                                  "<rgb name=\"color0\" value=\".9 .6 .9\"/><float name=\"color1\" "
                                                  "value=\".1\"/></texture><bsdf type=\"diffuse\"/></bsdf>",
                                                  version);
        // The first texel is that of small u and v, which has color0 in a colour.
        return grey_texel(read, read.material.alpha_texture, 0).g;
    };
    CHECK(opacity("3.0.0") == doctest::Approx(0.1));
    CHECK(opacity("0.6.0") == doctest::Approx(0.8));
}
