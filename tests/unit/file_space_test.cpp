#include <doctest/doctest.h>

#include "formats/read_scene.h"
#include "scene/scene_origin.h"
#include "session/opening/open_scene.h"
#include "tests/support/options.h"
#include "tests/support/thrown_error.h"
#include "tests/support/write_text.h"

namespace fs = std::filesystem;
using namespace pertev;

namespace file_space_test { // test files are compiled together

const std::string kCorner = "v 0 0 0\nv 1000 0 0\nv 0 2000 0\nv 0 0 4000\nf 1 2 3\nf 1 3 4\n";

/// Returns the bounds of a file that is read in this space.
Bounds3 bounds_in(const FileSpace& space, const std::string& name = "a.obj", const std::string& text = kCorner) {
    Messages messages;
    ReadOptions options;
    options.space = space;
    const Scene scene = read_scene(test::write_text(test::scratch_folder() / name, text), options, messages);
    const Bounds3 box = bounds_of(scene);
    return {to_float(in_file(scene, box.lo)), to_float(in_file(scene, box.hi))};
}

void check_box(const Bounds3& box, Vec3 lo, Vec3 hi) {
    CHECK(max_component(abs(box.lo - lo)) < 1e-6f);
    CHECK(max_component(abs(box.hi - hi)) < 1e-6f);
}

TEST_CASE("coordinates of a file become metres with y up, without mirroring") {
    check_box(bounds_in({}), {0, 0, 0}, {1000, 2000, 4000});
    check_box(bounds_in({UpAxis::Y, 0.001}), {0, 0, 0}, {1, 2, 4});
    check_box(bounds_in({UpAxis::Z, 0.001}), {0, 0, -2}, {1, 4, 0});
    check_box(bounds_in({UpAxis::X, 0.001}), {-2, 0, 0}, {0, 1, 4});
    const std::string ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                            "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                            "0 0 0\n1 0 0\n0 2 4\n3 0 1 2\n";
    check_box(bounds_in({UpAxis::Z, 0.0254}, "a.ply", ply), {0, 0, -0.0508f}, {0.0254f, 0.1016f, 0});
    for (const UpAxis up : {UpAxis::X, UpAxis::Y, UpAxis::Z}) {
        Messages messages;
        ReadOptions options;
        options.space = {up, 0.001};
        const Scene scene = read_scene(test::write_text(test::scratch_folder() / "a.obj", kCorner), options, messages);
        CHECK_FALSE(is_mirroring(scene.instances[0].world_from_local));
    }
}

TEST_CASE("coordinates far from the origin keep their digits when they are rotated and scaled") {
    Messages messages;
    ReadOptions options;
    options.space = {UpAxis::Z, 0.001};
    const std::string text = "v 448262257.5 5411933125.25 12000\nv 448263257.5 5411933125.25 12000\n"
                             "v 448262257.5 5411933125.25 13000\nf 1 2 3\n"; // survey coordinates in millimetres
    const Scene scene = read_scene(test::write_text(test::scratch_folder() / "a.obj", text), options, messages);
    const Bounds3 box = bounds_of(scene);
    const DoubleVec3 lo = in_file(scene, box.lo), hi = in_file(scene, box.hi);
    CHECK(lo.x == doctest::Approx(448262.2575).epsilon(1e-10));
    CHECK(lo.y == doctest::Approx(12).epsilon(1e-7));
    CHECK(lo.z == doctest::Approx(-5411933.12525).epsilon(1e-10));
    CHECK(hi.x - lo.x == doctest::Approx(1).epsilon(1e-6));
    CHECK(hi.y - lo.y == doctest::Approx(1).epsilon(1e-6));
    CHECK(hi.z - lo.z == doctest::Approx(0));
}

TEST_CASE("units are names or numbers of metres, axes are x, y and z, and other words are refused") {
    CHECK(file_space("", "") == FileSpace{});
    CHECK(file_space("z", "mm") == FileSpace{UpAxis::Z, 0.001});
    CHECK(file_space("X", "in") == FileSpace{UpAxis::X, 0.0254});
    CHECK(file_space("y", "ft").unit_m == 0.3048);
    CHECK(file_space("y", "cm").unit_m == 0.01);
    CHECK(file_space("y", "km").unit_m == 1000);
    CHECK(file_space("", "2.5e-3").unit_m == 0.0025);
    for (const char* unit : {"inch", "0", "-1", "nan", "inf", "1e-30", "mm ", "1m"}) {
        CAPTURE(unit);
        CHECK(test::is_about(test::thrown_error([&] { file_space("", unit); }), ErrorCode::BadInput, "unit", unit));
    }
    for (const char* axis : {"w", "-z", "zz", " z"}) {
        CAPTURE(axis);
        CHECK(test::is_about(test::thrown_error([&] { file_space(axis, ""); }), ErrorCode::BadInput, "up_axis", axis));
    }
}

TEST_CASE("files that define their unit and axis keep both, with a warning") {
    Messages messages;
    ReadOptions options;
    options.space = {UpAxis::Z, 0.001};
    const Bounds3 box = bounds_of(read_scene_and_emitters("cornell-box", options, messages));
    REQUIRE(messages.all().size() == 1);
    CHECK(messages.all()[0].is_warning);
    CHECK(messages.all()[0].remark.location == FileLocation{"cornell-box"});
    Messages none;
    CHECK(box == bounds_of(read_scene_and_emitters("cornell-box", {}, none)));
    CHECK(none.all().empty());
}

} // namespace file_space_test
