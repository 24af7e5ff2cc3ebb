// A report's description of its camera, and its list of measurements.

#include <doctest/doctest.h>

#include "base/json_text.h"
#include "lab/describe_camera.h"
#include "lab/list_combinations.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

TEST_CASE("a camera is described by settings that reproduce it") {
    Camera camera;
    camera.world_from_camera = look_at({0, 1, 3}, {0, 1, 0}, {0, 1, 0});
    camera.fov_y = kPi / 4;
    CHECK(describe_camera(camera) == "`eye=0,1,3` `target=0,1,-1` `up=0,1,0` `projection=perspective` `fov=45`");
    camera.projection = Projection::Orthographic, camera.ortho_height = 2.5f;
    CHECK(describe_camera(camera) == "`eye=0,1,3` `target=0,1,-1` `up=0,1,0` `projection=orthographic` "
                                     "`view_height=2.5`");
    // Far from the origin the target keeps the direction.
    const Vec3 eye = {1e6f, -2e6f, 3e5f}, way = normalize(Vec3{1, 2, -3});
    camera.world_from_camera = look_at(eye, eye + 1e6f * way, {0, 1, 0});
    const std::string text = describe_camera(camera);
    Vec3 target;
    REQUIRE(std::sscanf(text.c_str() + text.find("`target=") + 8, "%f,%f,%f", &target.x, &target.y, &target.z) == 3);
    CHECK(length(normalize(target - eye) - way) < 1e-6f);
}

TEST_CASE("combinations that cannot be measured are listed with the reason; if none can, that is an error") {
    LabSettings settings;
    settings.structures = {StructureKind::Binned};
    settings.traversals = {TraversalKind::Kd, TraversalKind::SkipLinks};
    settings.options = {{true, true}, {true, false}};
    settings.by_name = true;
    const auto list = list_combinations(settings, {});
    REQUIRE(list.size() == 4);
    CHECK_FALSE(list[0].refused.empty());
    CHECK(list[2].refused.empty());
    CHECK(list[3].name == "binned skip-links rta unordered");
    CHECK_FALSE(list[3].refused.empty());
    CHECK_NOTHROW(check_any_can_run(list));
    settings.traversals = {TraversalKind::Kd};
    const auto error = test::thrown_error([&] { check_any_can_run(list_combinations(settings, {})); });
    REQUIRE(error);
    CHECK(error->code() == ErrorCode::BadInput);
    CHECK(test::says(error, "\n  binned kd rta near and 1 more: "));
}

TEST_CASE("text of any bytes becomes UTF-8") {
    CHECK(utf8_text("a\xff\xc3\xa9\xc3.") == "a\xef\xbf\xbd\xc3\xa9\xef\xbf\xbd.");
    CHECK(utf8_text("").empty());
}
