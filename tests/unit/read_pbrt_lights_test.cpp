#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "formats/read_scene.h"
#include "formats/spectra/named_spectra.h"
#include "formats/spectra/spectrum.h"
#include "image/write_image.h"
#include "math/octahedron.h"
#include "math/portable_math.h"
#include "scene/intensity_table.h"
#include "scene/metals.h"
#include "tests/support/lit_scenes.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace {

const std::string kFloorText = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n";

Scene load_lit(const std::string& text, Messages& messages) {
    return read_scene(test::write_text(test::scratch_folder() / "lit.pbrt", text), {}, messages);
}
Scene load_lit(const std::string& text) {
    Messages messages;
    Scene scene = load_lit(text, messages);
    CHECK(messages.left_out() == std::vector<std::string>{});
    return scene;
}

void check_near(Rgb color, Rgb wanted, double epsilon = 2e-3) {
    CHECK(color.r == doctest::Approx(wanted.r).epsilon(epsilon));
    CHECK(color.g == doctest::Approx(wanted.g).epsilon(epsilon));
    CHECK(color.b == doctest::Approx(wanted.b).epsilon(epsilon));
}
void check_near(Vec3 p, Vec3 wanted) { CHECK(length(p - wanted) < 1e-5f); }

/// The emission of the first instance.
Rgb emission_of(const std::string& light, const std::string& end = "") {
    const Scene scene = load_lit("WorldBegin\n" + light + "\n" + kFloorText + end);
    return scene.materials[scene.instances[0].material].emission;
}

/// The point of a scene in the coordinates of its first camera, x to the right and y up, in front at negative z.
Vec3 seen(const Scene& scene, Vec3 p) { return transform_point(inverse(scene.cameras.at(0).world_from_camera), p); }

std::string suggestion(const Scene& scene, const std::string& name) {
    for (const SuggestedSetting& setting : scene.suggested) {
        if (setting.name == name) return setting.text;
    }
    return "";
}

} // namespace

TEST_CASE("spectra: colours of light are those of CIE") {
    check_near(color_of_chromaticity(0.31272, 0.32903), {1, 1, 1});
    CHECK(luminance(color_of_chromaticity(0.4, 0.4)) == doctest::Approx(1).epsilon(1e-3));
    const Spectrum constant = make_spectrum(std::vector<double>{400, 1, 700, 1});
    CHECK(luminance(color_of_light(constant)) == doctest::Approx(1).epsilon(1e-3));
    check_near(color_of_reflectance(constant), {1, 1, 1});
    check_near(color_of_reflectance(make_spectrum(std::vector<double>{700, 0.25, 400, 0.25})), {0.25f, 0.25f, 0.25f});
    // Illuminant A is a black body of 2856 K.
    check_near(color_of_unit_light(black_body(2856)), *find_illuminant("stdillum-A"), 5e-3);
    check_near(*find_illuminant("stdillum-d65"), {1, 1, 1});
    CHECK(black_body(5000).at(579.6) == doctest::Approx(1).epsilon(1e-3)); // Wien's law
    const Spectrum ramp = make_spectrum(std::vector<double>{500, 0, 600, 1});
    CHECK(ramp.at(550) == 0.5);
    CHECK(ramp.at(400) == 0);
    CHECK(ramp.at(900) == 1);
    const Rgb means = means_of_channels(ramp);
    CHECK(means.r > means.g);
    CHECK(means.g > means.b);
    check_near(means_of_channels(constant), {1, 1, 1});
}

TEST_CASE("spectra: metals and glasses have their names") {
    CHECK(find_metal_index("Au")->eta == find_metal("gold")->eta);
    CHECK(find_metal_index("copper")->k == find_metal("copper")->k);
    CHECK(find_metal_index("CuZn")->k == find_metal("brass")->k);
    CHECK(find_metal_index("MgO")->eta.g == doctest::Approx(1.737).epsilon(1e-3));
    CHECK_FALSE(find_metal_index("Unobtainium"));
    CHECK(find_glass("BK7")->ior == doctest::Approx(1.5168));
    CHECK_FALSE(find_glass("window"));
}

TEST_CASE("pbrt: area lights have the radiance that the file states") {
    check_near(emission_of("AreaLightSource \"diffuse\" \"rgb L\" [17 12 4]"), {17, 12, 4});
    check_near(emission_of("AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] \"float scale\" 2"), {2, 4, 6});
    // pbrt-v4: a spectrum that is no rgb has luminance 1.
    const Rgb warm = emission_of("AreaLightSource \"diffuse\" \"blackbody L\" 2700 \"float scale\" 5");
    CHECK(luminance(warm) == doctest::Approx(5).epsilon(2e-3));
    CHECK(warm.r > 2 * warm.b);
    CHECK(luminance(emission_of("AreaLightSource \"diffuse\" \"spectrum L\" [400 7 700 7]")) ==
          doctest::Approx(1).epsilon(2e-3));
    check_near(emission_of("AreaLightSource \"diffuse\" \"spectrum L\" \"stdillum-D65\""), {1, 1, 1});
    check_near(emission_of("AreaLightSource \"diffuse\""), {1, 1, 1});
    // pbrt-v3 takes values as they are, and a black body's over its brightest, times the second number.
    const Rgb old = emission_of("AreaLightSource \"diffuse\" \"blackbody L\" [5000 2]", "WorldEnd\n");
    CHECK(luminance(old) == doctest::Approx(2).epsilon(0.02));
    CHECK(luminance(emission_of("AreaLightSource \"diffuse\" \"spectrum L\" [400 7 700 7]", "WorldEnd # the end\n")) ==
          doctest::Approx(7).epsilon(2e-3));
    check_near(emission_of("AreaLightSource \"area\" \"color L\" [1 1 1] \"color scale\" [1 2 3]", "WorldEnd\n"),
               {1, 2, 3});
    // 10 W from each of the triangles, of area 1/2: 10 / (pi / 2).
    check_near(emission_of("AreaLightSource \"diffuse\" \"float power\" 10"), grey(6.3662f));
    const Scene of_two = load_lit("WorldBegin\nAreaLightSource \"diffuse\" \"float power\" 10\nShape \"trianglemesh\" "
                                  "\"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] \"integer indices\" [0 1 2 1 3 2]\n");
    check_near(of_two.materials[of_two.instances[0].material].emission, grey(6.3662f));
    check_near(emission_of("AreaLightSource \"diffuse\" \"float power\" 10 \"bool twosided\" true"), grey(3.1831f));
    check_near(emission_of("Scale 2 2 2 AreaLightSource \"diffuse\" \"float power\" 10"), grey(6.3662f / 4));
}

TEST_CASE("pbrt: an area light belongs to its block, and nothing emits through an interface") {
    Messages messages;
    const Scene scene = load_lit("WorldBegin AttributeBegin AreaLightSource \"diffuse\" \"bool twosided\" true\n" +
                                     kFloorText + "AttributeEnd\n" + kFloorText +
                                     "AttributeBegin Material \"interface\" AreaLightSource \"diffuse\"\n" +
                                     kFloorText + "AttributeEnd\n",
                                 messages);
    CHECK(messages.left_out().size() == 1);
    REQUIRE(scene.instances.size() == 2);
    CHECK(scene.materials[scene.instances[0].material].two_sided_emission);
    CHECK(scene.materials[scene.instances[1].material].emission == Rgb{0, 0, 0});
    CHECK(scene.materials[scene.instances[1].material].name == "default");
}

TEST_CASE("pbrt: point, spot and distant lights have their amounts, positions and directions") {
    const Scene scene =
        load_lit("WorldBegin Translate 1 0 0\n"
                 "LightSource \"point\" \"rgb I\" [1 2 3] \"point3 from\" [0 5 0] \"float scale\" 2\n"
                 "LightSource \"point\" \"float power\" 12.566371\n"
                 "LightSource \"spot\" \"point3 from\" [0 4 0] \"point3 to\" [0 0 0] \"float coneangle\" 60 \"float "
                 "conedeltaangle\" 15\n"
                 "LightSource \"distant\" \"rgb L\" [3 3 3] \"point3 from\" [0 0 0] \"point3 to\" [0 -2 0]\n"
                 "LightSource \"distant\" \"float illuminance\" 7\n" +
                 kFloorText);
    REQUIRE(scene.lights.size() == 5);
    CHECK(scene.lights[0].kind == LightKind::Point);
    check_near(scene.lights[0].intensity, {2, 4, 6});
    check_near(scene.lights[0].position, {1, 5, 0});
    check_near(scene.lights[1].intensity, {1, 1, 1});
    REQUIRE(scene.lights[2].kind == LightKind::Goniometric);
    check_near(scene.lights[2].direction, {0, -1, 0});
    CHECK(scene.lights[2].table->last_angle == doctest::Approx(kPi / 3));
    const std::vector<float>& ramp = scene.lights[2].table->values.pixels; // 3/4 of the way it begins, in the angle
    CHECK(ramp[3 * 768] == 1);
    CHECK(ramp[3 * 769] < 1);
    const double t =
        (static_cast<double>(std::cos(0.875f * kPi / 3)) - 0.5) / (std::sqrt(0.5) - 0.5); // pbrt's smooth step
    CHECK(ramp[3 * 896] == doctest::Approx(t * t * (3 - 2 * t)).epsilon(1e-4));
    CHECK(scene.lights[3].kind == LightKind::Directional);
    check_near(scene.lights[3].direction, {0, -1, 0});
    check_near(scene.lights[3].intensity, {3, 3, 3});
    check_near(scene.lights[4].direction, {0, 0, 1});
    check_near(scene.lights[4].intensity, {7, 7, 7});
}

TEST_CASE("pbrt: goniometric and projection lights face where pbrt has them") {
    const fs::path folder = test::scratch_folder();
    // Three bright pixels: towards +x of the octahedron, which is +x of the light, and +y, which is its +z.
    Image square{.width = 8, .height = 8, .channels = 3, .pixels = std::vector<float>(192, 0.0f)};
    for (const std::size_t pixel : {8 * 3 + 7, 8 * 4 + 7, 8 * 7 + 4}) {
        for (std::size_t channel = 0; channel < 3; ++channel) square.pixels[3 * pixel + channel] = 2;
    }
    write_exr(folder / "lamp.exr", square);
    const std::string file = " \"string filename\" \"lamp.exr\"\n";
    const auto load = [&](const std::string& light, const std::string& end = "") {
        Messages messages;
        Scene scene =
            read_scene(test::write_text(folder / "lit.pbrt", "WorldBegin Translate 0 5 0\n" + light + kFloorText + end),
                       {}, messages);
        CHECK(messages.left_out() == std::vector<std::string>{});
        REQUIRE(scene.lights.size() == 1);
        return scene;
    };
    const auto at = [](const Scene& scene, Vec3 offset) { // intensity in a direction of the light's own axes
        const test::Lights lights(scene);
        LightSample sample;
        const Light& light = scene.lights[0];
        const Vec3 right = (light.is_mirrored ? -1.0f : 1.0f) * cross(light.direction, light.up);
        const Vec3 to = offset.x * right + offset.y * light.direction + offset.z * light.up;
        if (!sample_punctual_light<EmitterVariant::Coated>(lights.view, 0, 1, light.position + to, sample)) return 0.0f;
        return sample.radiance.g * length_squared(offset);
    };
    const Scene lamp = load("LightSource \"goniometric\" \"rgb I\" [1 3 1]" + file);
    CHECK(at(lamp, {1, 0, 0}) == doctest::Approx(6));
    CHECK(at(lamp, {0.1f, 0.05f, 1}) == doctest::Approx(6));
    CHECK(at(lamp, {-1, 0, 0}) == 0);
    CHECK(at(lamp, {0, 0, -1}) == 0);
    CHECK(at(lamp, {0, 1, 0}) == 0);
    // Its power is 4 pi times the mean.
    const Scene watts = load("LightSource \"goniometric\" \"float power\" 10" + file);
    CHECK(at(watts, {1, 0, 0}) == doctest::Approx(10 / (4 * kPi) * 64 / 3));
    // The picture's upper side is +y of the light, as pbrt-v4 has it; the shorter side has the field of view.
    Image wide{.width = 4, .height = 2, .channels = 3, .pixels = std::vector<float>(24, 1.0f)};
    wide.pixels[1] = 7;
    write_exr(folder / "lamp.exr", wide);
    const Scene beam = load("LightSource \"projection\" \"float fov\" 90" + file);
    const Light& light = beam.lights[0];
    CHECK(light.table->half_height == doctest::Approx(1));
    CHECK(light.table->half_width == doctest::Approx(2));
    CHECK(at(beam, {-1.9f, 1, 0.9f}) == doctest::Approx(7));
    CHECK(at(beam, {1.9f, 1, 0.9f}) == doctest::Approx(1));
    CHECK(at(beam, {-1.9f, 1, -0.9f}) == doctest::Approx(1));
    CHECK(at(beam, {-1.9f, 1, 1.1f}) == 0);
    check_near(light.up, {0, 1, 0});
    // pbrt-v3 shows the first row below, and its file is a mapname.
    const Scene old =
        load("LightSource \"projection\" \"float fov\" 90 \"string mapname\" \"lamp.exr\"\n", "WorldEnd\n");
    check_near(old.lights[0].up, {0, -1, 0});
    CHECK(at(old, {-1.9f, 1, 0.9f}) == doctest::Approx(7));
    CHECK(old.lights[0].is_mirrored != light.is_mirrored);
}

TEST_CASE("pbrt: the angle of a light that it cannot have is left out at its line") {
    for (const auto& [light, says] :
         {std::pair("\"spot\" \"float coneangle\" 120", "the coneangle of 120 degrees is left out; 89.9 is used"),
          {"\"spot\" \"float conedeltaangle\" -5", "the conedeltaangle of -5 degrees"}}) {
        CAPTURE(light);
        Messages messages;
        const Scene scene = load_lit(std::string("WorldBegin\nLightSource ") + light + "\n" + kFloorText, messages);
        CHECK(scene.lights.size() == 1);
        REQUIRE(messages.left_out().size() == 1);
        CHECK(messages.left_out()[0].find(says) != std::string::npos);
        CHECK(messages.left_out()[0].find(":2") != std::string::npos);
    }
    for (const char* const light : {"\"spot\" \"float coneangle\" 90", "\"goniometric\" \"float fov\" 179.5"}) {
        CAPTURE(light);
        Messages messages;
        (void)load_lit(std::string("WorldBegin\nLightSource ") + light + "\n" + kFloorText, messages);
        CHECK(messages.left_out().empty());
    }
}

TEST_CASE("pbrt: a transform that stretches a light is left out at its line, where it matters") {
    for (const char* const light : {"spot", "goniometric", "point"}) {
        for (const char* const scale : {"2 2 2", "-3 3 3", "1 2 1"}) {
            CAPTURE(light);
            CAPTURE(scale);
            Messages messages;
            (void)load_lit(std::string("WorldBegin\nScale ") + scale + " LightSource \"" + light + "\"\n" + kFloorText,
                           messages);
            const bool is_told = light != std::string("point") && scale == std::string("1 2 1");
            REQUIRE(messages.left_out().size() == (is_told ? 1 : 0));
            if (is_told) CHECK(messages.left_out()[0].find(":2") != std::string::npos);
        }
    }
}

TEST_CASE("pbrt: a light whose strength or place is not a finite number is left out alone, at its line") {
    for (const std::string light : {"LightSource \"point\" \"float scale\" 1e30 \"rgb I\" [1e30 1 1]",
                                    "LightSource \"point\" \"float power\" 1e300 \"rgb I\" [0 1 1]",
                                    "LightSource \"point\" \"point3 from\" [0 0 5e12]",
                                    "Scale 1e30 1e30 1e30 LightSource \"spot\" \"point3 from\" [0 0 1e30]",
                                    "LightSource \"distant\" \"float illuminance\" 1e300",
                                    "LightSource \"infinite\" \"float scale\" 1e30 \"rgb L\" [1e30 1 1]",
                                    "LightSource \"infinite\" \"float illuminance\" 1e300",
                                    "AreaLightSource \"diffuse\" \"float scale\" 1e30 \"rgb L\" [1e30 1 1]"}) {
        CAPTURE(light);
        Messages messages;
        const Scene scene = load_lit("WorldBegin LightSource \"distant\"\nAttributeBegin\n" + light +
                                         "\nShape \"disk\" AttributeEnd\n" + kFloorText,
                                     messages);
        REQUIRE_FALSE(scene.instances.empty());
        CHECK(scene.lights.size() == 1);
        CHECK(is_black(scene.environment->scale));
        for (const Material& material : scene.materials) CHECK(is_black(material.emission));
        CHECK(std::ranges::any_of(messages.all(), [](const Message& message) {
            return message.is_left_out && message.remark.location && message.remark.location->line == 3;
        }));
    }
    // The largest sum of two that are finite, and a power that fits no float.
    Messages messages;
    const Scene scene = load_lit("WorldBegin LightSource \"infinite\" \"rgb L\" [3e38 0 0]\nLightSource \"infinite\" "
                                 "\"rgb L\" [3e38 0 0]\nAreaLightSource \"diffuse\" \"rgb L\" [0 1 0] \"float power\" "
                                 "1e300\n" +
                                     kFloorText,
                                 messages);
    CHECK(scene.environment->scale == Rgb{3e38f, 0, 0});
    CHECK(scene.materials[scene.instances[0].material].emission == Rgb{0, 0x1p40f, 0});
    CHECK(messages.left_out().size() == 1);
}

TEST_CASE("pbrt: no default light is added to a file without light, and infinite lights add up") {
    const Scene dark = load_lit("WorldBegin\n" + kFloorText);
    REQUIRE(dark.environment);
    CHECK(is_black(dark.environment->scale));
    const Scene lit = load_lit("WorldBegin LightSource \"infinite\" \"rgb L\" [1 2 3] LightSource \"infinite\" \"rgb "
                               "L\" [1 1 1] \"float scale\" 2\n" +
                               kFloorText);
    check_near(lit.environment->scale, {3, 4, 5});
    // An illuminance of pi is a radiance of 1.
    check_near(load_lit("WorldBegin LightSource \"infinite\" \"float illuminance\" 3.14159265\n" + kFloorText)
                   .environment->scale,
               {1, 1, 1});
}

TEST_CASE("pbrt: the octahedron's middle is +z, its corners -z, and its sides x and y") {
    const auto is_at = [](Vec2 p, float x, float y) { return std::abs(p.x - x) < 1e-6f && std::abs(p.y - y) < 1e-6f; };
    CHECK(is_at(octahedral_uv({0, 0, 1}), 0.5f, 0.5f));
    CHECK(is_at(octahedral_uv({1, 0, 0}), 1, 0.5f));
    CHECK(is_at(octahedral_uv({-1, 0, 0}), 0, 0.5f));
    CHECK(is_at(octahedral_uv({0, 1, 0}), 0.5f, 1));
    CHECK(is_at(octahedral_uv({0, -1, 0}), 0.5f, 0));
    const Vec2 below = octahedral_uv({0, 0, -1});
    CHECK((below.x == 0 || below.x == 1));
    // Equal areas: half of the upper hemisphere is within a diamond of half its area.
    const float z = 0.5f, r = sqrt(1 - z * z);
    const Vec2 p = octahedral_uv({r, 0, z});
    CHECK(2 * square(2 * p.x - 1) == doctest::Approx(1));
    // The inverse, in all eight octants.
    for (int i = 0; i < 64; ++i) {
        const Vec2 place = {(static_cast<float>(i % 8) + 0.3f) / 8, (static_cast<float>(i / 8) + 0.4f) / 8};
        const Vec2 back = octahedral_uv(octahedral_direction(place));
        CHECK(is_at(back, place.x, place.y));
    }
}

TEST_CASE("pbrt: pictures of infinite lights face where pbrt has them") {
    const fs::path folder = test::scratch_folder();
    // A bright pixel at +x of the light, in each of both forms.
    Image square{.width = 16, .height = 16, .channels = 3, .pixels = std::vector<float>(768, 0.0f)};
    for (const std::size_t y : {7, 8}) square.pixels[3 * (16 * y + 15)] = 1;
    Image wide{.width = 32, .height = 16, .channels = 3, .pixels = std::vector<float>(1536, 0.0f)};
    for (const std::size_t y : {7, 8}) {
        for (const std::size_t x : {0, 31}) wide.pixels[3 * (32 * y + x)] = 1;
    }
    write_image(folder / "square.exr", square);
    write_image(folder / "wide.exr", wide);
    const auto brightest = [&](const std::string& text) {
        Messages messages;
        const Scene scene = read_scene(test::write_text(folder / "scene.pbrt", text + kFloorText), {}, messages);
        CHECK(messages.left_out().empty());
        const Image& image = scene.environment->image;
        Vec3 sum;
        for (uint32_t y = 0; y < image.height; ++y) {
            for (uint32_t x = 0; x < image.width; ++x) {
                const float angle = 2 * kPi * ((float(x) + 0.5f) / float(image.width) - 0.5f),
                            down = kPi * (float(y) + 0.5f) / float(image.height);
                sum += image.pixels[3 * (std::size_t(y) * image.width + x)] *
                       Vec3{sin(down) * sin(angle), cos(down), -sin(down) * cos(angle)};
            }
        }
        return normalize(sum);
    };
    const auto is_near = [](Vec3 a, Vec3 b) { return dot(a, b) > 0.99f; };
    const std::string v4 = "LightSource \"infinite\" \"string filename\" \"square.exr\"\n",
                      v3 = "LightSource \"infinite\" \"string mapname\" \"wide.exr\"\n";
    for (const std::string& light : {v4, v3}) {
        CHECK(is_near(brightest("WorldBegin " + light), {1, 0, 0}));
        CHECK(is_near(brightest("WorldBegin Rotate 90 0 0 1 " + light), {0, 1, 0}));
        CHECK(is_near(brightest("WorldBegin Rotate -90 0 1 0 " + light), {0, 0, 1}));
        // A left-handed world is mirrored, and its light with it.
        CHECK(is_near(brightest("LookAt 0 0 -5 0 0 0 0 1 0 Camera \"perspective\" WorldBegin " + light), {-1, 0, 0}));
    }
}

TEST_CASE("pbrt: pictures are not mirrored, whether the camera mirrors or not") {
    // Right of the middle, above, and in front of the camera.
    const std::string mark =
        "Shape \"trianglemesh\" \"point3 P\" [1 2 0 1.001 2 0 1 2.001 0] \"integer indices\" [0 1 2]\n";
    const auto seen_mark = [&](const std::string& view) {
        const Scene scene = load_lit(view + "Camera \"perspective\"\nWorldBegin\n" + mark);
        return seen(scene, transform_point(scene.instances[0].world_from_local, scene.meshes[0].positions[0]));
    };
    check_near(seen_mark("LookAt 0 0 -5 0 0 0 0 1 0 "), {1, 2, -5});
    check_near(seen_mark("Translate 0 0 5 "), {1, 2, -5});
    check_near(seen_mark("Scale -1 1 1 LookAt 0 0 5 0 0 0 0 1 0 "), {1, 2, -5});
    check_near(seen_mark("Transform [1 0 0 0 0 1 0 0 0 0 -1 0 0 -1 6.8 1] "), {1, 1, -6.8f});
    check_near(seen_mark("Scale 2 2 2 Translate 0 0 5 "), {1, 2, -5});
}

TEST_CASE("pbrt: the field of view is that of the shorter side") {
    const auto camera_of = [](const std::string& film, const std::string& parameters,
                              const std::string& type = "perspective") {
        return load_lit("Film \"rgb\" " + film + "\nTranslate 0 0 1 Camera \"" + type + "\" " + parameters +
                        "\nWorldBegin\n" + kFloorText)
            .cameras.at(0);
    };
    const std::string wide = "\"integer xresolution\" 200 \"integer yresolution\" 100",
                      tall = "\"integer xresolution\" 100 \"integer yresolution\" 200";
    CHECK(camera_of(wide, "\"float fov\" 60").fov_y == doctest::Approx(kPi / 3));
    CHECK(camera_of(wide, "").fov_y == doctest::Approx(kPi / 2));
    CHECK(tan(0.5f * camera_of(tall, "\"float fov\" 60").fov_y) == doctest::Approx(2 * tan(kPi / 6)));
    CHECK(camera_of(tall, "").aspect == 0.5f);
    const Camera lens = camera_of(wide, "\"float lensradius\" .1 \"float focaldistance\" 3");
    CHECK(lens.aperture_radius == 0.1f);
    CHECK(lens.focus_distance == 3);
    CHECK(camera_of(wide, "", "orthographic").ortho_height == 2);
    CHECK(camera_of(tall, "", "orthographic").ortho_height == 4);
    CHECK(camera_of(wide, "\"float screenwindow\" [-2 2 -3 3]", "orthographic").ortho_height == 6);
    const Camera half = camera_of(wide, "\"float fov\" 90 \"float screenwindow\" [0 2 0 1]"); // the upper right quarter
    REQUIRE(half.intrinsics);
    CHECK(half.intrinsics->focal_x == doctest::Approx(100));
    CHECK(half.intrinsics->focal_y == doctest::Approx(100));
    CHECK(half.intrinsics->centre_x == doctest::Approx(0));
    CHECK(half.intrinsics->centre_y == doctest::Approx(100));
}

TEST_CASE("pbrt: the file suggests size, samples, depth, filter and exposure") {
    const Scene scene =
        load_lit("Film \"rgb\" \"integer xresolution\" 300 \"integer yresolution\" 200 \"float iso\" 400 \"string "
                 "filename\" \"a.exr\"\n"
                 "Sampler \"zsobol\" \"integer pixelsamples\" 32 Integrator \"volpath\" \"integer maxdepth\" 7\n"
                 "PixelFilter \"triangle\" \"float xradius\" 1 \"float yradius\" 1 WorldBegin\n" +
                 kFloorText);
    CHECK(suggestion(scene, "size") == "300x200");
    CHECK(suggestion(scene, "spp") == "32");
    CHECK(suggestion(scene, "max_depth") == "7");
    CHECK(suggestion(scene, "filter") == "tent");
    CHECK(suggestion(scene, "filter_radius") == "1");
    CHECK(suggestion(scene, "exposure") == "2");
    CHECK(scene.cameras.empty());
    CHECK(suggestion(load_lit("WorldBegin\n" + kFloorText), "max_depth") == "5"); // pbrt's own
    // The time of the shutter and the film's speed are the exposure; sensors of pbrt have that of the observer.
    const std::string shutter = "Camera \"perspective\" \"float shutteropen\" .25 \"float shutterclose\" .5 ";
    CHECK(suggestion(load_lit(shutter + "Film \"rgb\" WorldBegin\n" + kFloorText), "exposure") == "-2");
    CHECK(suggestion(load_lit(shutter + "WorldBegin\n" + kFloorText), "exposure") == "-2");
    CHECK(suggestion(load_lit(shutter + "Film \"rgb\" WorldBegin\n" + kFloorText + "WorldEnd\n"), "exposure").empty());
    const auto left_out = [](const char* film) {
        Messages messages;
        (void)load_lit(std::string("Film \"rgb\" ") + film + " WorldBegin\n" + kFloorText, messages);
        return messages.left_out().size();
    };
    CHECK(left_out("\"string sensor\" \"cie1931\" \"float whitebalance\" 6500") == 0);
    CHECK(left_out("\"string sensor\" \"nikon_d850\"") == 1);
    CHECK(left_out("\"string sensor\" \"nikon\"") == 1);
    CHECK(left_out("\"string sensor\" \"nikon_d850\" \"float whitebalance\" 3000") == 2);
}

TEST_CASE("pbrt: a light in the camera's coordinates moves with it") {
    const Scene scene = load_lit(
        "Scale -1 1 1 LookAt 3 0 0 4 0 0 0 1 0 Camera \"perspective\" WorldBegin CoordSysTransform \"camera\"\n"
        "LightSource \"point\" \"point3 from\" [0 0 2]\n" +
        kFloorText);
    check_near(scene.lights.at(0).position, {5, 0, 0});
}
