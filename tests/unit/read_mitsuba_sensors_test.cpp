// Mitsuba's sensors: the films of several, and what a camera lacks of them.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <vector>

#include "formats/read_scene.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace {

struct ReadSensors {
    Scene scene;
    std::vector<std::string> left_out;
};

/// Reads a scene of these sensors and a square of 2 x 2 m at z = 0.
ReadSensors read_sensors(const std::string& sensors) {
    Messages messages;
    ReadSensors read;
    read.scene =
        read_scene(test::write_text(test::scratch_folder() / "scene.xml",
                                    "<scene version=\"3.0.0\">" + sensors + "<shape type=\"rectangle\"/></scene>"),
                   {}, messages);
    read.left_out = messages.left_out();
    return read;
}

std::string sensor_film(int width, int height, const std::string& more = "") {
    return fmt::format("<film type=\"hdrfilm\"><integer name=\"width\" value=\"{}\"/><integer name=\"height\" "
                       "value=\"{}\"/>{}</film>",
                       width, height, more);
}

/// A sensor at (0, 0, 5) that looks along -z.
std::string sensor_of(const std::string& inner, const std::string& type = "perspective",
                      const std::string& first = "") {
    return fmt::format("<sensor type=\"{}\"><transform name=\"to_world\">{}<lookat origin=\"0,0,5\" target=\"0,0,0\" "
                       "up=\"0,1,0\"/></transform>{}</sensor>",
                       type, first, inner);
}

std::size_t sensor_lacks(const std::string& inner, const std::string& says) {
    const ReadSensors read = read_sensors(sensor_of("<float name=\"fov\" value=\"40\"/>" + inner));
    for (const std::string& text : read.left_out) CHECK_MESSAGE(text.find(says) != text.npos, text);
    return read.left_out.size();
}

std::string sensor_number(const char* name, double value) {
    return fmt::format("<float name=\"{}\" value=\"{}\"/>", name, value);
}

} // namespace

TEST_CASE("mitsuba: each sensor suggests the size, samples and filter of its own film") {
    const ReadSensors read = read_sensors(
        "<sensor type=\"perspective\" id=\"A\">" + sensor_film(32, 20, "<rfilter type=\"box\"/>") + "</sensor>" +
        "<sensor type=\"perspective\" id=\"B\"><sampler type=\"independent\"><integer name=\"sample_count\" "
        "value=\"9\"/></sampler>" +
        sensor_film(40, 20, "<rfilter type=\"box\"/>") + "</sensor><sensor type=\"perspective\" id=\"C\"/>");
    CHECK(read.left_out.empty());
    std::string suggested;
    for (const SuggestedSetting& setting : read.scene.suggested) suggested += setting.name + "=" + setting.text + " ";
    CHECK(suggested == "size=32x20 filter=box filter_radius=0.5 size@B=40x20 spp@B=9 size@C=768x576 ");
}

TEST_CASE("mitsuba: an orthographic sensor with another scale along y is named") {
    const auto of_scale = [](const char* scale) {
        const ReadSensors read = read_sensors(sensor_of(sensor_film(40, 20), "orthographic", scale));
        REQUIRE(read.scene.cameras.size() == 1);
        CHECK(read.scene.cameras[0].ortho_height == doctest::Approx(3));
        return read.left_out.size();
    };
    CHECK(of_scale("<scale x=\"3\" y=\"3\"/>") == 0);
    CHECK(of_scale("<scale x=\"3\" y=\"2\"/>") == 1);
}

TEST_CASE("mitsuba: clipping planes are named if they cut anything that the sensor sees") {
    CHECK(sensor_lacks("", "") == 0);
    CHECK(sensor_lacks(sensor_number("near_clip", 4.9) + sensor_number("far_clip", 5.1), "") == 0);
    CHECK(sensor_lacks(sensor_number("near_clip", 5.1), "near_clip") == 1);
    CHECK(sensor_lacks(sensor_number("far_clip", 4.9), "far_clip") == 1);
    // A sensor a millimetre in front of the square, and one beside it, at which the square ends.
    const auto at = [](const char* place) {
        return read_sensors(
                   fmt::format("<sensor type=\"perspective\"><transform name=\"to_world\"><lookat origin=\"{}\" "
                               "target=\"{}\" up=\"0,1,0\"/></transform></sensor>",
                               place, "9,0,0"))
            .left_out.size();
    };
    CHECK(at("-0.5,0,0.001") == 1); // along the square: it begins before the plane at 0.01
    CHECK(at("-1.5,0,0.001") == 0);
    CHECK(at("-0.5,0,1") == 0);
}
