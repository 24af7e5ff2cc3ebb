// Interpolation of a camera path's keys.

#include "scene/camera_path.h"

#include <doctest/doctest.h>

#include "base/error.h"
#include "formats/read_camera_path.h"
#include "tests/support/options.h"
#include "tests/support/write_text.h"

using namespace pertev;

namespace {

CameraKey key(double time_s, float x, float fov_deg = 0) {
    const double at = static_cast<double>(x);
    return {.time_s = time_s, .eye = {at, 0, 5}, .target = {0, at, 0}, .fov_deg = fov_deg};
}

} // namespace

TEST_CASE("a path passes its keys at their times and is constant before and after") {
    const CameraPath path = {{key(1, 0), key(2, 4), key(5, -2)}};
    for (const CameraKey& k : path.keys) {
        CHECK(sample_path(path, k.time_s).eye == k.eye);
        CHECK(sample_path(path, k.time_s).target == k.target);
    }
    CHECK(sample_path(path, -7).eye == path.keys[0].eye);
    CHECK(sample_path(path, 1e9).eye == path.keys[2].eye);
    CHECK(sample_path(path, 1.5).up == Vec3{0, 1, 0});
    CHECK(sample_path(path, 1.5).fov_deg == 0);
    CHECK(sample_path({{key(3, 1)}}, 3.5).eye == DoubleVec3{1, 0, 5});
}

TEST_CASE("a path follows a parabola exactly between inner keys with uneven times, and a line everywhere") {
    const auto parabola = [](double t) { return static_cast<float>(t * t); };
    CameraPath path, line;
    for (const double t : {0.0, 1.0, 3.0, 4.0, 8.0}) {
        path.keys.push_back(key(t, parabola(t)));
        line.keys.push_back(key(t, static_cast<float>(2 * t)));
    }
    for (const double t : {1.25, 2.0, 3.5}) CHECK(sample_path(path, t).eye.x == doctest::Approx(parabola(t)));
    for (const double t : {0.5, 1.25, 3.5, 7.0}) CHECK(sample_path(line, t).target.y == doctest::Approx(2 * t));
}

TEST_CASE("speed is continuous at a key, and the field of view stays constant") {
    const CameraPath path = {{key(0, 0, 10), key(1, 4, 178), key(3, -2, 178), key(4, -2, 1)}};
    for (const double t : {1.0, 3.0}) {
        const double h = 1e-3, at = sample_path(path, t).eye.x;
        const double before = (at - sample_path(path, t - 1e-3).eye.x) / h;
        const double after = (sample_path(path, t + 1e-3).eye.x - at) / h;
        CHECK(before == doctest::Approx(after).epsilon(0.02));
    }
    for (double t = 0; t <= 4; t += 1.0 / 64) {
        CHECK(sample_path(path, t).fov_deg >= 0.01f);
        CHECK(sample_path(path, t).fov_deg <= 179);
    }
}

TEST_CASE("a file's times are read as doubles, and unused numbers beyond doubles are accepted") {
    const auto read = [](const std::string& keys) {
        return read_camera_path(test::write_text(test::scratch_folder() / "path.json", "{\"keys\":[" + keys + "]}"));
    };
    const std::string place = R"(,"eye":[0,0,5],"target":[0,0,0],"extras":[1e400,123456789012345678901234567890]})";
    const CameraPath path =
        read(R"({"time":0.1)" + place + R"(,{"time":86400.0001)" + place + R"(,{"time":86400.0002)" + place);
    REQUIRE(path.keys.size() == 3);
    CHECK(path.keys[0].time_s == 0.1);
    CHECK(path.keys[2].time_s == 86400.0002);
    CHECK_THROWS_AS(read(R"({"time":NaN)" + place),
                    Error); // Pertev's own formats are not repaired if they are invalid JSON
}
