#pragma once

// Materials of one square in a scene file of Mitsuba, and elements of such files.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "formats/read_scene.h"
#include "image/srgb.h"
#include "image/write_image.h"
#include "image/write_png.h"
#include "math/portable_math.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

namespace pertev::test {

/// Returns what is left out besides black backs, which tests/unit/read_mitsuba_lacks_test.cpp checks.
inline std::vector<std::string> left_out_besides_backs(const Messages& messages) {
    std::vector<std::string> texts = messages.left_out();
    std::erase_if(texts, [](const std::string& text) { return text.find("the black back of") != text.npos; });
    return texts;
}

struct MitsubaMaterial {
    Scene scene;
    Material material;
    Messages messages;
};

/// Reads a file whose only shape is a square with the BSDF `bsdf`, in a folder with the pictures a.exr (two pixels of
/// 0.25 and 0.5), a.png (one of 128) and veil.png (one of 128 with alpha 51).
inline MitsubaMaterial load_bsdf(const std::string& bsdf, const std::string& version = "3.0.0") {
    const std::filesystem::path folder = test::scratch_folder();
    write_image(folder / "a.exr",
                Image{.width = 2, .height = 1, .channels = 3, .pixels = {0.25f, 0.25f, 0.25f, 0.5f, 0.5f, 0.5f}});
    const float linear = srgb_decode(128 / 255.0f);
    write_image(folder / "a.png", Image{.width = 1, .height = 1, .channels = 3, .pixels = {linear, linear, linear}});
    write_png(folder / "veil.png", Rgba8Image{1, 1, {128, 128, 128, 51}}, true);
    test::write_text(folder / "a.spd", "# nm value\n400 .2\n500 .8\n600 .1\n700 .4\n");
    MitsubaMaterial read;
    read.scene =
        read_scene(test::write_text(folder / "scene.xml",
                                    fmt::format("<scene version=\"{}\"><shape type=\"rectangle\">{}</shape></scene>",
                                                version, bsdf)),
                   {}, read.messages);
    if (!read.scene.instances.empty()) read.material = read.scene.materials[read.scene.instances[0].material];
    return read;
}
inline Material mitsuba_material(const std::string& bsdf, const std::string& version = "3.0.0") {
    const MitsubaMaterial read = load_bsdf(bsdf, version);
    CHECK(read.messages.left_out() == std::vector<std::string>{});
    return read.material;
}
inline std::string bsdf_of(const std::string& type, const std::string& inner = "") {
    return fmt::format("<bsdf type=\"{}\">{}</bsdf>", type, inner);
}
inline std::string number_of(const char* name, double value) {
    return fmt::format("<float name=\"{}\" value=\"{}\"/>", name, value);
}
inline std::string rgb_of(const char* name, const char* value) {
    return fmt::format("<rgb name=\"{}\" value=\"{}\"/>", name, value);
}
inline std::string string_of(const char* name, const char* value) {
    return fmt::format("<string name=\"{}\" value=\"{}\"/>", name, value);
}
inline std::string bitmap_of(const char* name, const std::string& inner, const char* file = "a.exr") {
    return fmt::format("<texture name=\"{}\" type=\"bitmap\">{}{}</texture>", name, string_of("filename", file), inner);
}

inline void check_mitsuba_color(Rgb color, Rgb wanted, double epsilon = 2e-3) {
    CHECK(color.r == doctest::Approx(wanted.r).epsilon(epsilon));
    CHECK(color.g == doctest::Approx(wanted.g).epsilon(epsilon));
    CHECK(color.b == doctest::Approx(wanted.b).epsilon(epsilon));
}
inline Rgb mitsuba_reflectance(const std::string& value, const char* version = "3.0.0") {
    return mitsuba_material(bsdf_of("diffuse", value), version).base_color;
}
inline Rgb mitsuba_radiance(const std::string& value, const char* version = "3.0.0") {
    return mitsuba_material("<emitter type=\"area\">" + value + "</emitter>", version).emission;
}

/// The nearest texel of a texture at coordinates of Mitsuba.
inline float mitsuba_texel(const MitsubaMaterial& read, const TextureRef& ref, float u, float v) {
    const Image& image = read.scene.images.at(static_cast<std::size_t>(ref.image)).rgba_float;
    const float x = ref.m00 * u + ref.m01 * v + ref.m02, y = ref.m10 * u + ref.m11 * v + ref.m12;
    const auto column = static_cast<uint32_t>((x - floor(x)) * float(image.width)),
               row = static_cast<uint32_t>((y - floor(y)) * float(image.height));
    return image.pixels.at(4 * (std::size_t(row) * image.width + column));
}

} // namespace pertev::test
