// Mitsuba's surfaces have black backs, light that passes emitters, and reduced reflections, which ours lack or have
// nearly.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tests/support/mitsuba_materials.h"

using namespace pertev;
using namespace pertev::test;

namespace {

/// Returns what a scene of these elements leaves out, seen from (0, 0, 5) along -z.
std::vector<std::string> mitsuba_lacks(const std::string& text, const std::string& origin = "0,0,5") {
    Messages messages;
    (void)read_scene(
        test::write_text(
            test::scratch_folder() / "scene.xml",
            fmt::format("<scene version=\"3.0.0\"><sensor type=\"perspective\"><transform name=\"to_world\"><lookat "
                        "origin=\"{}\" target=\"0,0,0\" up=\"0,1,0\"/></transform></sensor>{}</scene>",
                        origin, text)),
        {}, messages);
    return messages.left_out();
}

std::string lacking_shape(const char* type, const std::string& bsdf, const char* steps = "", const char* more = "") {
    return fmt::format("<shape type=\"{}\"><transform name=\"to_world\">{}</transform>{}{}</shape>", type, steps, bsdf,
                       more);
}

} // namespace

TEST_CASE("mitsuba: black backs are named where one may show") {
    const std::string paint = bsdf_of("diffuse"), both = bsdf_of("twosided", paint);
    const char* const turned = "<rotate y=\"1\" angle=\"180\"/>";
    CHECK(mitsuba_lacks(lacking_shape("rectangle", paint)).empty()); // the sensor is in front, and nothing behind
    const std::vector<std::string> back = mitsuba_lacks(lacking_shape("rectangle", paint, turned));
    REQUIRE(back.size() == 1);
    CHECK(back[0].find("the black back of rectangle is left out") != std::string::npos);
    CHECK(mitsuba_lacks(lacking_shape("rectangle", both, turned)).empty());
    CHECK(mitsuba_lacks(lacking_shape("rectangle", bsdf_of("thindielectric"), turned)).empty());
    CHECK(mitsuba_lacks(lacking_shape("rectangle", "", turned)).size() == 1); // Mitsuba's default is one-sided, too
    // Closed shapes hide their backs from outside, and room-like ones from inside.
    const char* const reversed = "<boolean name=\"flip_normals\" value=\"true\"/>";
    for (const char* const type : {"sphere", "cube"}) {
        CAPTURE(type);
        CHECK(mitsuba_lacks(lacking_shape(type, paint)).empty());
        CHECK(mitsuba_lacks(lacking_shape(type, paint, "<scale x=\"-2\" y=\"2\" z=\"2\"/>")).empty());
        CHECK(mitsuba_lacks(lacking_shape(type, paint, "<scale value=\"9\"/>")).size() == 1);
        CHECK(mitsuba_lacks(lacking_shape(type, paint, "<scale value=\"9\"/>", reversed)).empty());
        CHECK(mitsuba_lacks(lacking_shape(type, paint, "", reversed)).size() == 1);
        CHECK(mitsuba_lacks(lacking_shape(type, bsdf_of("mask", paint))).size() == 1); // through the holes
    }
    CHECK(mitsuba_lacks(lacking_shape("cylinder", paint)).size() == 1);
    // The walls of a room have all in front of them; a sheet in the middle has not.
    const std::string room =
        lacking_shape("rectangle", paint, "<scale value=\"6\"/><translate z=\"-6\"/>") +
        lacking_shape("rectangle", paint, "<scale value=\"6\"/><rotate y=\"1\" angle=\"90\"/><translate x=\"-6\"/>") +
        lacking_shape("sphere", paint);
    CHECK(mitsuba_lacks(room).empty());
    const std::vector<std::string> sheets =
        mitsuba_lacks(room + lacking_shape("rectangle", paint) + lacking_shape("disk", paint, "<translate z=\"-2\"/>"));
    REQUIRE(sheets.size() == 1);
    CHECK(sheets[0].find("and of 1 other shape is left out") != std::string::npos);
}

TEST_CASE("mitsuba: light that passes an emitter of null is named") {
    const char* const lamp = "<emitter type=\"area\"/>";
    CHECK(mitsuba_lacks(lacking_shape("rectangle", bsdf_of("diffuse"), "", lamp)).empty());
    CHECK(mitsuba_lacks(lacking_shape("rectangle", bsdf_of("null"), "", lamp)).size() == 1);
}

TEST_CASE("mitsuba: the texture that a scale multiplies may have any name") {
    for (const char* const name : {"", "name=\"texture\"", "name=\"nested\""}) {
        const MitsubaMaterial read = load_bsdf(bsdf_of(
            "diffuse", fmt::format("<texture name=\"reflectance\" type=\"scale\">{}<texture {} type=\"bitmap\">{}"
                                   "</texture></texture>",
                                   number_of("scale", 0.5), name, string_of("filename", "a.exr"))));
        CHECK(read.messages.left_out() == std::vector<std::string>{});
        CHECK(read.material.base_color_texture.has_image());
        CHECK(read.material.base_color.r == 0.5f);
    }
}

TEST_CASE("mitsuba: plastic reflects less by its specular_reflectance, at all angles") {
    const MitsubaMaterial dim = load_bsdf(bsdf_of("plastic", rgb_of("specular_reflectance", ".4 .2 .1")));
    CHECK(dim.messages.left_out() == std::vector<std::string>{});
    CHECK(dim.messages.all().size() == 1);
    CHECK(dim.material.specular_weight == 0.4f);
    check_mitsuba_color(dim.material.specular_color, {1, 0.5f, 0.25f});
    CHECK(load_bsdf(bsdf_of("plastic")).messages.all().empty());
}

TEST_CASE("mitsuba: parameters of normal maps are known") {
    const auto said = [](const char* value) {
        const MitsubaMaterial read = load_bsdf(
            bsdf_of("normalmap", bitmap_of("normalmap", "<boolean name=\"raw\" value=\"true\"/>") +
                                     fmt::format("<boolean name=\"use_shadowing_function\" value=\"{}\"/><boolean "
                                                 "name=\"flip_invalid_normals\" value=\"false\"/>",
                                                 value) +
                                     bsdf_of("diffuse")));
        CHECK(read.messages.left_out() == std::vector<std::string>{});
        return read.messages.all().size();
    };
    CHECK(said("false") == 0);
    CHECK(said("true") == 1);
}
