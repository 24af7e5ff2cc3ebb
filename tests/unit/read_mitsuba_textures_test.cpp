// Textures of Mitsuba's scenes: bitmaps, checkerboards, bumps and normal maps.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tests/support/mitsuba_materials.h"

using namespace pertev;
using namespace pertev::test;

TEST_CASE("mitsuba: bitmaps have wraps, filters, places and encodings") {
    const MitsubaMaterial read = load_bsdf(
        bsdf_of("diffuse",
                bitmap_of("reflectance",
                          string_of("filter_type", "nearest") + string_of("wrap_mode", "mirror") +
                              "<transform name=\"to_uv\"><scale x=\"2\" y=\"3\"/><translate x=\".5\"/></transform>")));
    const TextureRef& ref = read.material.base_color_texture;
    CHECK(ref.filter == TextureFilter::Nearest);
    CHECK(ref.wrap_s == Wrap::MirroredRepeat);
    CHECK(ref.m00 == 2);
    CHECK(ref.m11 == 3);
    CHECK(ref.m02 == 0.5f);
    CHECK(read.material.base_color == grey(1));
    // The first row of a picture has v = 0.
    CHECK(mitsuba_texel(load_bsdf(bsdf_of("diffuse", bitmap_of("reflectance", ""))), TextureRef{.image = 0}, 0.25f,
                        0.1f) == 0.25f);
    const Material old = mitsuba_material(
        bsdf_of("diffuse", bitmap_of("reflectance", number_of("uscale", 4) + number_of("voffset", 0.25))), "0.6.0");
    CHECK(old.base_color_texture.m00 == 4);
    CHECK(old.base_color_texture.m12 == 0.25f);
    CHECK(mitsuba_material(bsdf_of("diffuse", bitmap_of("reflectance", "", "a.png"))).base_color_texture.is_srgb);
    CHECK(!mitsuba_material(
               bsdf_of("diffuse", bitmap_of("reflectance", "<boolean name=\"raw\" value=\"true\"/>", "a.png")))
               .base_color_texture.is_srgb);
    CHECK(load_bsdf(bsdf_of("diffuse", bitmap_of("reflectance", "", "none.png"))).material.base_color == grey(0.5f));
}

TEST_CASE("mitsuba: numbers of encoded pictures are decoded, and alpha channels are ignored") {
    const MitsubaMaterial rough =
        load_bsdf(bsdf_of("roughconductor", string_of("material", "Au") + bitmap_of("alpha", "", "a.png")));
    const float linear = srgb_decode(128 / 255.0f);
    CHECK(mitsuba_texel(rough, rough.material.roughness_texture, 0, 0) == doctest::Approx(std::sqrt(linear)));
    for (const char* file : {"a.png", "veil.png"}) {
        const MitsubaMaterial masked = load_bsdf(bsdf_of("mask", bitmap_of("opacity", "", file) + bsdf_of("diffuse")));
        CHECK(mitsuba_texel(masked, masked.material.alpha_texture, 0, 0) == doctest::Approx(linear));
        CHECK(masked.material.alpha_texture.channel == 0);
    }
}

TEST_CASE("mitsuba: a checkerboard begins with color0, and scale multiplies") {
    const MitsubaMaterial read =
        load_bsdf(bsdf_of("diffuse", "<texture type=\"checkerboard\" name=\"reflectance\">" + rgb_of("color0", ".75") +
                                         rgb_of("color1", ".25") + "</texture>"));
    const TextureRef& ref = read.material.base_color_texture;
    CHECK(mitsuba_texel(read, ref, 0.1f, 0.1f) == 0.75f);
    CHECK(mitsuba_texel(read, ref, 0.6f, 0.1f) == 0.25f);
    CHECK(mitsuba_texel(read, ref, 0.1f, 0.6f) == 0.25f);
    CHECK(mitsuba_texel(read, ref, 0.6f, 0.6f) == 0.75f);
    CHECK(ref.filter == TextureFilter::Nearest);
    const Material scaled = mitsuba_material(
        bsdf_of("diffuse", "<texture type=\"scale\" name=\"reflectance\"><float name=\"scale\" value=\".5\"/>" +
                               bitmap_of("", "") + "</texture>"),
        "0.6.0");
    CHECK(scaled.base_color == grey(0.5f));
    CHECK(scaled.base_color_texture.has_image());
    CHECK(
        load_bsdf(bsdf_of("diffuse", "<texture type=\"checkers\" name=\"reflectance\"/>")).messages.left_out().size() ==
        1);
}

TEST_CASE("mitsuba: bumps and normal maps") {
    CHECK(mitsuba_material(bsdf_of("normalmap", bitmap_of("normalmap", "<boolean name=\"raw\" value=\"true\"/>") +
                                                    bsdf_of("diffuse")))
              .normal_texture.has_image());
    const Material bumpy =
        mitsuba_material(bsdf_of("bumpmap", bitmap_of("arbitrary", "<boolean name=\"raw\" value=\"true\"/>") +
                                                number_of("scale", 2) + bsdf_of("diffuse")));
    const Material flatter = mitsuba_material(
        bsdf_of("bumpmap", bitmap_of("arbitrary", "<boolean name=\"raw\" value=\"true\"/>") + bsdf_of("diffuse")));
    CHECK(bumpy.normal_texture.has_image());
    CHECK(bumpy.normal_scale == doctest::Approx(2 * flatter.normal_scale));
    const MitsubaMaterial checks =
        load_bsdf(bsdf_of("bumpmap", "<texture type=\"checkerboard\">" + number_of("color0", 0) +
                                         number_of("color1", 0.125) + "</texture>" + bsdf_of("diffuse")));
    CHECK(checks.messages.left_out() == std::vector<std::string>{});
    REQUIRE(checks.material.normal_texture.has_image());
    CHECK(mitsuba_texel(checks, checks.material.normal_texture, 0.25f, 0.25f) == 0.5f);
    CHECK(std::abs(mitsuba_texel(checks, checks.material.normal_texture, 0.499f, 0.25f) - 0.5f) > 0.01f);
}
