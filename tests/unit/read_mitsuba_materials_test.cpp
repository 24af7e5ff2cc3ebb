// BSDFs, spectra and emitters of Mitsuba's scenes.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "formats/described/make_surface.h"
#include "formats/mitsuba/bsdfs.h"
#include "scene/metals.h"
#include "tests/support/mitsuba_materials.h"
#include "tests/support/thrown_error.h"

using namespace pertev;
using namespace pertev::test;

TEST_CASE("mitsuba: reflectances have their colours under D65") {
    check_mitsuba_color(mitsuba_reflectance(rgb_of("reflectance", ".1, .2, .3")), {0.1f, 0.2f, 0.3f});
    check_mitsuba_color(mitsuba_reflectance(""), grey(0.5f));
    check_mitsuba_color(mitsuba_reflectance("<srgb name=\"reflectance\" value=\"#808080\"/>", "0.6.0"), grey(0.21586f));
    check_mitsuba_color(mitsuba_reflectance("<spectrum name=\"reflectance\" value=\".3\"/>"), grey(0.3f));
    // The numbers are those of Mitsuba 3.9.
    const Rgb wanted = {0, 0.533364f, 0.534482f};
    check_mitsuba_color(
        mitsuba_reflectance("<spectrum name=\"reflectance\" value=\"400:.2, 500:.8, 600:.1, 700:.4\"/>"), wanted, 0.01);
    check_mitsuba_color(mitsuba_reflectance("<spectrum name=\"reflectance\" filename=\"a.spd\"/>"), wanted, 0.01);
    check_mitsuba_color(
        mitsuba_reflectance("<spectrum name=\"reflectance\" type=\"regular\"><float name=\"wavelength_min\" "
                            "value=\"400\"/><float name=\"wavelength_max\" value=\"700\"/>" +
                            string_of("values", ".2, .8, .1, .4") + "</spectrum>"),
        wanted, 0.01);
    check_mitsuba_color(mitsuba_reflectance("<spectrum name=\"reflectance\" type=\"irregular\">" +
                                            string_of("wavelengths", "400,500,600,700") +
                                            string_of("values", ".2, .8, .1, .4") + "</spectrum>"),
                        wanted, 0.01);
    check_mitsuba_color(
        mitsuba_reflectance(
            "<spectrum name=\"reflectance\" type=\"uniform\"><float name=\"value\" value=\".7\"/></spectrum>"),
        grey(0.7f));
    CHECK(
        !load_bsdf(bsdf_of("diffuse", "<spectrum name=\"reflectance\" type=\"unifrm\"/>")).messages.left_out().empty());
}

TEST_CASE("mitsuba: colours of light are those of its radiance") {
    // The numbers are those of Mitsuba 3.9.
    check_mitsuba_color(mitsuba_radiance("<spectrum name=\"radiance\" value=\"400:0, 500:8, 600:15.6, 700:18.4\"/>"),
                        {20.7108f, 10.8546f, 2.77115f}, 0.01);
    check_mitsuba_color(mitsuba_radiance("<spectrum name=\"radiance\" value=\"2\"/>"), {2.40959f, 1.89658f, 1.81783f},
                        0.01);
    check_mitsuba_color(mitsuba_radiance("<spectrum name=\"radiance\" value=\"2\"/>", "0.6.0"), grey(2));
    check_mitsuba_color(mitsuba_radiance(rgb_of("radiance", "3 2 1")), {3, 2, 1});
    check_mitsuba_color(
        mitsuba_radiance("<spectrum name=\"radiance\" type=\"d65\"><float name=\"scale\" value=\"4\"/></spectrum>"),
        grey(4));
    check_mitsuba_color(mitsuba_radiance("<spectrum name=\"radiance\" type=\"blackbody\"><float name=\"temperature\" "
                                         "value=\"3000\"/></spectrum>"),
                        {733.5f, 350, 113.1f}, 0.01);
    check_mitsuba_color(mitsuba_radiance("<blackbody name=\"radiance\" temperature=\"3000K\" scale=\".1\"/>", "0.6.0"),
                        {73.35f, 35, 11.31f}, 0.01);
}

TEST_CASE("mitsuba: an area emitter emits from the front, and its image is that of the emission") {
    const Material plain = mitsuba_material("<emitter type=\"area\">" + rgb_of("radiance", "3") + "</emitter>");
    CHECK(!plain.two_sided_emission);
    const MitsubaMaterial image = load_bsdf("<emitter type=\"area\">" + bitmap_of("radiance", "") + "</emitter>");
    CHECK(image.material.emission_texture.has_image());
    CHECK(image.material.emission == grey(1));
    const MitsubaMaterial bent =
        load_bsdf("<emitter type=\"area\">" + bitmap_of("radiance", number_of("gamma", 2)) + "</emitter>", "0.6.0");
    const auto of_bent = static_cast<std::size_t>(bent.material.emission_texture.image);
    CHECK(bent.scene.images.at(of_bent).rgba_float.pixels[4] == doctest::Approx(0.25)); // 0.5 squared
}

TEST_CASE("mitsuba: metals by name, by numbers and by nothing") {
    const Material gold =
        mitsuba_material(bsdf_of("roughconductor", string_of("material", "Au") + number_of("alpha", 0.25)));
    CHECK(gold.kind == MaterialKind::Conductor);
    check_mitsuba_color(gold.eta, {0.14304f, 0.37531f, 1.4420f});
    CHECK(gold.roughness == doctest::Approx(0.5));
    CHECK(gold.energy == MicrofacetEnergy::Single);
    CHECK(gold.microfacet_distribution == MicrofacetDistribution::Beckmann);
    const Material ggx =
        mitsuba_material(bsdf_of("roughconductor", string_of("material", "Al") + string_of("distribution", "ggx")));
    CHECK(ggx.microfacet_distribution == MicrofacetDistribution::Ggx);
    CHECK(ggx.roughness == doctest::Approx(std::sqrt(0.1)));
    // The numbers are those of Mitsuba 3.9.
    const Material listed =
        mitsuba_material(bsdf_of("conductor", "<spectrum name=\"eta\" value=\"400:1.5,500:1,600:.4,700:.3\"/><spectrum "
                                              "name=\"k\" value=\"400:2,700:4\"/>"));
    check_mitsuba_color(listed.eta, {0.247094f, 0.737936f, 1.29431f}, 0.01);
    check_mitsuba_color(listed.k, {3.59898f, 2.95242f, 2.2619f}, 0.01);
    CHECK(listed.roughness == 0);
    check_mitsuba_color(mitsuba_material(bsdf_of("conductor"), "0.6.0").eta, {0.20101f, 0.92375f, 1.1022f});
    const Material mirror = mitsuba_material(bsdf_of("conductor"));
    const float loss = 4 * mirror.eta.g / (square(1 + mirror.eta.g) + square(mirror.k.g));
    CHECK(loss < 1e-3f);
    CHECK(mitsuba_material(bsdf_of("conductor", rgb_of("specular_reflectance", ".5"))).specular_weight == 0.5f);
    CHECK(!load_bsdf(bsdf_of("conductor", string_of("material", "Unobtainium"))).messages.left_out().empty());
}

TEST_CASE("mitsuba: named conductors reflect what they do there") {
    struct Row {
        const char* name;
        Rgb reflected; // by a square under a white sky at 0 degrees, by Mitsuba 3.9.1's scalar_rgb
    };
    for (const Row& row : {Row{"Au", {0.9667f, 0.8020f, 0.3241f}}, Row{"Cr", {0.6876f, 0.6491f, 0.6870f}},
                           Row{"Ta", {0.4565f, 0.3419f, 0.3799f}}, Row{"Se", {0.3793f, 0.2507f, 0.2413f}},
                           Row{"SnTe", {0.4070f, 0.1084f, 0.0152f}}, Row{"CuO", {0.2907f, 0.1982f, 0.1834f}},
                           Row{"Cu2O", {0.3147f, 0.2455f, 0.2379f}}, Row{"d-C", {0.2123f, 0.1579f, 0.1449f}},
                           Row{"ThF4_palik", {0.0861f, 0.0328f, 0.0264f}}}) {
        CAPTURE(row.name);
        const Material metal = mitsuba_material(bsdf_of("conductor", string_of("material", row.name)));
        const auto reflected = [](float eta, float k) {
            return (square(eta - 1) + square(k)) / (square(eta + 1) + square(k));
        };
        check_mitsuba_color(
            {reflected(metal.eta.r, metal.k.r), reflected(metal.eta.g, metal.k.g), reflected(metal.eta.b, metal.k.b)},
            row.reflected, 3e-3);
    }
    check_mitsuba_color(mitsuba_material(bsdf_of("conductor", string_of("material", "Na"))).k,
                        {3.1793f, 2.1125f, 1.579f});
    CHECK(mitsuba_material(bsdf_of("conductor", string_of("material", "Ti"))).eta == find_metal("titanium")->eta);
    CHECK(load_bsdf(bsdf_of("conductor", string_of("material", "SnTee"))).messages.left_out().at(0).find("\"SnTe\"") !=
          std::string::npos);
}

TEST_CASE("mitsuba: a grey specular_reflectance weighs a metal exactly, a colour nearly") {
    const std::string index = rgb_of("eta", ".2 .92 1.1") + rgb_of("k", "3.9 2.45 2.14");
    const Material grey_metal = mitsuba_material(bsdf_of("conductor", index + rgb_of("specular_reflectance", ".3")));
    CHECK(grey_metal.kind == MaterialKind::Conductor);
    CHECK(grey_metal.specular_weight == 0.3f);
    const Material red = mitsuba_material(bsdf_of("conductor", index + rgb_of("specular_reflectance", ".5 .2 .1")));
    CHECK(red.kind == MaterialKind::MetallicRoughness);
    CHECK(red.metal_fresnel == MetalFresnel::F82);
    CHECK(red.base_color.r == doctest::Approx(0.5 * 0.9535).epsilon(5e-3));
    const MitsubaMaterial checks =
        load_bsdf(bsdf_of("conductor", index + "<texture type=\"checkerboard\" name=\"specular_reflectance\">" +
                                           rgb_of("color0", ".8") + rgb_of("color1", ".2") + "</texture>"));
    CHECK(checks.material.kind == MaterialKind::Conductor);
    CHECK(mitsuba_texel(checks, checks.material.specular_texture, 0.1f, 0.1f) == doctest::Approx(0.8f));
    CHECK(mitsuba_texel(checks, checks.material.specular_texture, 0.6f, 0.1f) == doctest::Approx(0.2f));
}

TEST_CASE("mitsuba: stretched microfacets are wide along u") {
    const Material wide = mitsuba_material(
        bsdf_of("roughconductor", string_of("material", "Au") + number_of("alpha_u", 0.4) + number_of("alpha_v", 0.1)));
    CHECK(wide.roughness == doctest::Approx(std::sqrt(0.1)));
    CHECK(wide.specular_roughness_anisotropy == doctest::Approx(std::sqrt(0.3 / 0.9)));
    CHECK(wide.anisotropy_rotation == 0);
}

TEST_CASE("mitsuba: dielectrics by the names of substances and by numbers") {
    CHECK(mitsuba::find_ior("diamond") == 2.419f);
    const Material plain = mitsuba_material(bsdf_of("dielectric"));
    CHECK(plain.kind == MaterialKind::Dielectric);
    CHECK(plain.ior == doctest::Approx(1.5046 / 1.000277));
    CHECK(mitsuba_material(bsdf_of("dielectric", string_of("intIOR", "Water") + string_of("extIOR", "vacuum")), "0.6.0")
              .ior == doctest::Approx(1.333));
    const Material rough =
        mitsuba_material(bsdf_of("roughdielectric", number_of("int_ior", 1.8) + number_of("ext_ior", 1) +
                                                        number_of("alpha", 0.09) + string_of("distribution", "ggx")));
    CHECK(rough.ior == doctest::Approx(1.8));
    CHECK(rough.roughness == doctest::Approx(0.3));
    CHECK(rough.microfacet_distribution == MicrofacetDistribution::Ggx);
    const Material thin =
        mitsuba_material(bsdf_of("thindielectric", number_of("int_ior", 1.5) + number_of("ext_ior", 1)));
    CHECK(thin.thin_walled);
    CHECK(thin.transmission_weight == 1);
    const float reflected = square((thin.ior - 1) / (thin.ior + 1));
    CHECK(reflected == doctest::Approx(2 * 0.04 / 1.04).epsilon(1e-3));
    // Factors on what a pane reflects and transmits; the wall transmits (1 - weight reflected) of its colour.
    const std::string tints = rgb_of("specular_reflectance", ".5 .25 0") + rgb_of("specular_transmittance", ".8 .6 .4");
    const Material tinted =
        mitsuba_material(bsdf_of("thindielectric", number_of("int_ior", 1.5) + number_of("ext_ior", 1) + tints));
    CHECK(tinted.specular_weight == 0.5f);
    CHECK(tinted.specular_color == Rgb{1, 0.5f, 0});
    CHECK((1 - 0.5f * reflected) * tinted.base_color.g == doctest::Approx(0.6f * (1 - reflected)));
    CHECK(mitsuba_material(bsdf_of("thindielectric", number_of("specular_reflectance", 0))).specular_weight == 0);
}

TEST_CASE("mitsuba: the index of an interface is that inside over that outside, whatever surrounds it") {
    const std::string bubble = number_of("int_ior", 1) + number_of("ext_ior", 1.5);
    for (const char* const type : {"dielectric", "roughdielectric"}) {
        const Material air = mitsuba_material(bsdf_of(type, bubble));
        CHECK(air.ior == doctest::Approx(1 / 1.5));
        CHECK(air.has_relative_ior);
    }
    CHECK(mitsuba_material(bsdf_of("dielectric")).has_relative_ior);
    CHECK(mitsuba_material(bsdf_of("principled", number_of("spec_trans", 1))).has_relative_ior);
    CHECK_FALSE(mitsuba_material(bsdf_of("plastic")).has_relative_ior);
    // A coat and a pane have no bubbles' side.
    for (const char* const type : {"plastic", "thindielectric"}) {
        const MitsubaMaterial inverted = load_bsdf(bsdf_of(type, bubble));
        CHECK(inverted.messages.left_out().size() == 1);
        CHECK(inverted.material.ior >= 1.5f);
    }
    CHECK(load_bsdf(bsdf_of("dielectric", number_of("int_ior", 1e-9))).material.ior ==
          doctest::Approx(1.5046 / 1.000277));
}

TEST_CASE("mitsuba: the colour of plastic is that of the whole, or with nonlinear that beneath the coat") {
    const std::string ior = number_of("int_ior", 1.5) + number_of("ext_ior", 1) + rgb_of("diffuse_reflectance", ".5");
    const Material whole = mitsuba_material(bsdf_of("plastic", ior));
    CHECK(whole.kind == MaterialKind::MetallicRoughness);
    CHECK(whole.ior == 1.5f);
    CHECK(whole.base_color.r == doctest::Approx(0.5).epsilon(1e-2)); // Schlick lets a little more in
    CHECK(mitsuba_material(bsdf_of("plastic")).ior == doctest::Approx(1.49 / 1.000277));
    const std::string nonlinear = "<boolean name=\"nonlinear\" value=\"true\"/>";
    const float inside = described::reflected_inside(1.5f);
    CHECK(mitsuba_material(bsdf_of("plastic", ior + nonlinear)).base_color.r ==
          doctest::Approx(0.5f * (1 - inside) / (1 - 0.5f * inside)).epsilon(1e-2));
    const Material dyed = mitsuba_material(bsdf_of("roughplastic", ior + nonlinear));
    CHECK(dyed.roughness == doctest::Approx(std::sqrt(0.1)));
    // Light is lost in wide microfacets (statistical/mitsuba_lobes_test.cpp has how much), beneath a texture, too.
    const std::string wide = number_of("int_ior", 1.5) + number_of("alpha", 0.5) + string_of("distribution", "ggx");
    const float base =
        mitsuba_material(bsdf_of("roughplastic", wide + rgb_of("diffuse_reflectance", ".5"))).base_color.r;
    CHECK(base > 0.2f);
    CHECK(base < 0.3f);
    CHECK(mitsuba_material(bsdf_of("roughplastic", wide + bitmap_of("diffuse_reflectance", ""))).base_color.r ==
          doctest::Approx(2 * base));
}

TEST_CASE("mitsuba: phong, ward, roughdiffuse and coating are the nearest, with a warning") {
    for (const char* const type : {"phong", "ward", "roughdiffuse"}) {
        const MitsubaMaterial read = load_bsdf(bsdf_of(type), "0.6.0");
        CHECK(read.messages.left_out() == std::vector<std::string>{});
        CHECK(read.messages.all().size() == 1);
    }
    CHECK(load_bsdf(bsdf_of("phong", number_of("exponent", 6))).material.roughness == doctest::Approx(std::sqrt(0.5)));
    const Material coated = mitsuba_material(
        bsdf_of("coating", number_of("intIOR", 1.4) + number_of("extIOR", 1) + bsdf_of("diffuse")), "0.6.0");
    CHECK(coated.coat_weight == 1);
    CHECK(coated.coat_ior == 1.4f);
    CHECK(coated.coat_color == Rgb{1, 1, 1});
    const MitsubaMaterial tinted = load_bsdf(
        bsdf_of("roughcoating", number_of("alpha_u", 0.4) + number_of("alpha_v", 0.1) + number_of("thickness", 0.5) +
                                    rgb_of("sigma_a", "0 .5 2") + bsdf_of("roughconductor", number_of("alpha", 0.2))),
        "0.6.0");
    CHECK(tinted.messages.left_out() == std::vector<std::string>{});
    const Material& coat = tinted.material;
    CHECK(coat.coat_color.r == 1); // both ways of 0.5 each
    CHECK(coat.coat_color.g == doctest::Approx(std::exp(-0.5)));
    CHECK(coat.coat_color.b == doctest::Approx(std::exp(-2.0)));
    CHECK(coat.coat_roughness == doctest::Approx(std::sqrt(0.1)));
    CHECK(coat.coat_roughness_anisotropy == doctest::Approx(std::sqrt(0.3 / 0.9)));
    CHECK(!coat.has_anisotropy());
    const std::string inner = bsdf_of("roughcoating", bitmap_of("alpha", "") + bsdf_of("diffuse"));
    const Material twice = load_bsdf(bsdf_of("roughcoating", number_of("alpha", 0.25) + inner), "0.6.0").material;
    CHECK(twice.coat_roughness == 0.5f); // the outer one counts
    CHECK(!twice.coat_roughness_texture.has_image());
    const MitsubaMaterial varied =
        load_bsdf(bsdf_of("coating", bitmap_of("thickness", "") + bsdf_of("diffuse")), "0.6.0");
    CHECK(varied.messages.left_out().size() == 1);
}

TEST_CASE("mitsuba: principled has its parameters") {
    const Material m = mitsuba_material(bsdf_of(
        "principled", rgb_of("base_color", ".1 .2 .3") + number_of("metallic", 0.25) + number_of("roughness", 0.6) +
                          number_of("spec_trans", 0.5) + number_of("clearcoat", 1) + number_of("specular", 0.5)));
    check_mitsuba_color(m.base_color, 1.05f * Rgb{0.1f, 0.2f, 0.3f},
                        0.02); // statistical/mitsuba_lobes_test.cpp has why
    CHECK(m.metallic == 0.25f);
    CHECK(m.roughness == 0.6f);
    CHECK(m.transmission_weight == 0.5f);
    CHECK(!m.thin_walled);
    CHECK(m.coat_weight == 0.25f);
    CHECK(m.ior == doctest::Approx(1.5));
    CHECK(mitsuba_material(bsdf_of("principled", number_of("eta", 1.33))).ior == 1.33f);
    const std::string bubble = number_of("eta", 0.75);
    CHECK(mitsuba_material(bsdf_of("principled", bubble + number_of("spec_trans", 1))).ior == 0.75f);
    const MitsubaMaterial opaque = load_bsdf(bsdf_of("principled", bubble)); // reflects the same at 0 degrees
    CHECK(opaque.material.ior == doctest::Approx(1 / 0.75));
    CHECK(opaque.messages.left_out().size() == 1);
    // Two interfaces have the base colour together.
    const std::string clear = rgb_of("base_color", ".04 .25 1") + number_of("spec_trans", 1);
    check_mitsuba_color(mitsuba_material(bsdf_of("principled", clear)).base_color, {0.2f, 0.5f, 1});
    check_mitsuba_color(mitsuba_material(bsdf_of("principledthin", clear)).base_color, {0.04f, 0.25f, 1});
    CHECK(mitsuba_material(bsdf_of("principledthin", number_of("diff_trans", 1))).diffuse_transmission_weight == 0.5f);
    // A texture of the colour makes up for the reflection, too, and one of the roughness takes the anisotropy.
    const Material mapped = mitsuba_material(bsdf_of("principled", bitmap_of("base_color", "")));
    const MitsubaMaterial plain = load_bsdf(bsdf_of("principled", rgb_of("base_color", ".25")));
    const Scene bright = load_bsdf(bsdf_of("principled", bitmap_of("base_color", ""))).scene;
    CHECK(mapped.base_color == grey(1));
    CHECK(bright.images[0].rgba_float.pixels[0] == doctest::Approx(plain.material.base_color.r));
    const MitsubaMaterial brushed =
        load_bsdf(bsdf_of("principled", number_of("anisotropic", 0.5) + bitmap_of("roughness", "")));
    CHECK(brushed.messages.left_out().size() == 1);
}

TEST_CASE("mitsuba: twosided, mask, null and mixtures") {
    const std::string red = bsdf_of("diffuse", rgb_of("reflectance", "1 0 0")),
                      blue = bsdf_of("diffuse", rgb_of("reflectance", "0 0 1"));
    CHECK(mitsuba_material(bsdf_of("twosided", red)).base_color == Rgb{1, 0, 0});
    CHECK(load_bsdf(bsdf_of("twosided", red + blue)).messages.left_out().size() == 1);
    CHECK(load_bsdf(bsdf_of("twosided")).messages.left_out().size() == 1);
    const Material half = mitsuba_material(bsdf_of("mask", number_of("opacity", 0.25) + red));
    CHECK(half.alpha == 0.25f);
    CHECK(half.alpha_mode == AlphaMode::Blend);
    CHECK(test::thrown_error([&] { (void)load_bsdf(bsdf_of("null")); }).has_value()); // nothing is left to see
    CHECK(mitsuba_material(bsdf_of("blendbsdf", number_of("weight", 0.25) + red + blue)).base_color ==
          Rgb{0.75f, 0, 0.25f});
    CHECK(mitsuba_material(bsdf_of("blendbsdf", number_of("weight", 0.25) + red + bsdf_of("null"))).alpha == 0.75f);
    const Material three =
        mitsuba_material(bsdf_of("mixturebsdf", string_of("weights", ".5 .25 .25") + red + blue + red), "0.6.0");
    CHECK(three.base_color.r == doctest::Approx(0.75));
    CHECK(three.base_color.b == doctest::Approx(0.25));
    CHECK(load_bsdf(bsdf_of("mixturebsdf", string_of("weights", ".5") + red + blue)).messages.left_out().size() == 1);
    const std::string dark = bsdf_of("mixturebsdf", string_of("weights", ".5 .25") + red + blue); // the rest is lost
    check_mitsuba_color(mitsuba_material(dark, "0.6.0").base_color, {0.5f, 0, 0.25f});
}

TEST_CASE("mitsuba: an unknown BSDF is grey") {
    const MitsubaMaterial read = load_bsdf(bsdf_of("difuse"));
    CHECK(read.material.base_color == grey(0.5f));
    REQUIRE(read.messages.left_out().size() == 1);
    CHECK(read.messages.left_out()[0].find("did you mean \"diffuse\"?") != std::string::npos);
    CHECK(load_bsdf(bsdf_of("hair")).messages.left_out().size() == 1);
}

TEST_CASE("mitsuba: a spectrum is dark beyond its wavelengths") {
    const Rgb narrow = mitsuba_radiance("<spectrum name=\"radiance\" value=\"500:1, 600:1\"/>");
    CHECK(narrow.b == doctest::Approx(0).epsilon(1e-2));
    CHECK(narrow.g > 3 * narrow.r);
    const Rgb green = mitsuba_reflectance("<spectrum name=\"reflectance\" value=\"500:1, 550:1\"/>");
    CHECK(green.g > 5 * green.r);
}

TEST_CASE("mitsuba: spectra that contain themselves are left out, and the scale of a coloured d65 counts") {
    for (const char* const type : {"d65", "srgb", "rgb"}) {
        CAPTURE(type);
        const MitsubaMaterial read = load_bsdf(
            bsdf_of("diffuse", fmt::format("<spectrum name=\"reflectance\" type=\"{}\" id=\"s\"><ref name=\"color\" "
                                           "id=\"s\"/></spectrum>",
                                           type)));
        CHECK(read.messages.left_out().size() >= 1);
        CHECK(read.scene.instances.size() == 1);
    }
    check_mitsuba_color(mitsuba_radiance("<spectrum name=\"radiance\" type=\"d65\"><float name=\"scale\" value=\"7\"/>"
                                         "<rgb name=\"color\" value=\"1 2 0\"/></spectrum>"),
                        {7, 14, 0});
}

TEST_CASE("mitsuba: an emitter without a BSDF is black, but not in version 0.6") {
    const std::string lamp = "<emitter type=\"area\"/>";
    CHECK(is_black(mitsuba_material(lamp).base_color));
    CHECK_FALSE(is_black(mitsuba_material(lamp, "0.6.0").base_color));
}

TEST_CASE("mitsuba: what a shape has twice, or has no use for, is left out by name") {
    const std::string red = bsdf_of("diffuse", rgb_of("reflectance", "1 0 0"));
    const MitsubaMaterial two = load_bsdf(red + bsdf_of("conductor"));
    CHECK(two.material.base_color == Rgb{1, 0, 0});
    REQUIRE(two.messages.left_out().size() == 1);
    CHECK(two.messages.left_out()[0].find(
              "the bsdf conductor is left out, because the shape rectangle has another bsdf") != std::string::npos);
    const std::string light = "<emitter type=\"area\"/>";
    CHECK(load_bsdf(light + light).messages.left_out().size() == 1);
    CHECK(load_bsdf(red + bitmap_of("", "")).messages.left_out().size() == 1);
    const MitsubaMaterial same =
        load_bsdf("<bsdf type=\"diffuse\" id=\"a\"/><texture id=\"a\" name=\"t\" type=\"checkerboard\"/>");
    bool is_named = false;
    for (const Message& message : same.messages.all())
        is_named = is_named || message.text.find("another object has the id a") != std::string::npos;
    CHECK(is_named);
}

TEST_CASE("mitsuba: a thin principled surface transmits the colours of its texture") {
    const MitsubaMaterial leaf =
        load_bsdf(bsdf_of("principledthin", bitmap_of("base_color", "") + number_of("diff_trans", 1)));
    CHECK(leaf.material.diffuse_transmission_weight == 0.5f);
    CHECK(leaf.material.diffuse_transmission_color_texture.has_image());
    CHECK(leaf.material.diffuse_transmission_color_texture.image == leaf.material.base_color_texture.image);
}

TEST_CASE("mitsuba: colours of vertices are no weights and opacities") {
    const std::string red = bsdf_of("diffuse", rgb_of("reflectance", "1 0 0"));
    const auto attribute = [](const char* name) {
        return fmt::format("<texture name=\"{}\" type=\"mesh_attribute\">{}{}</texture>", name,
                           string_of("name", "vertex_color"), number_of("scale", 0.25));
    };
    const MitsubaMaterial masked = load_bsdf(bsdf_of("mask", attribute("opacity") + red));
    CHECK(masked.messages.left_out().size() == 1);
    CHECK(masked.material.alpha == 0.25f);
    const MitsubaMaterial blended =
        load_bsdf(bsdf_of("blendbsdf", attribute("weight") + red + bsdf_of("diffuse", rgb_of("reflectance", "0 0 1"))));
    CHECK(blended.messages.left_out().size() == 1);
    CHECK(blended.material.base_color == Rgb{0.75f, 0, 0.25f});
}
