// Camera movements (apps/viewer/steering.h): each follows its key, and flags of the command line reproduce the camera.

#include <cmath>

#include <doctest/doctest.h>

#include "apps/viewer/steering.h"
#include "render/camera_view.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

const Pose kStart = {{0, 1, 5}, {0, 1, 0}, {0, 1, 0}, {0, 1, 0}}; // looks along -z

bool near(Vec3 a, Vec3 b, float tolerance = 1e-4f) { return length(a - b) < tolerance; }

Vec3 ahead(const Pose& pose) { return normalize(pose.target - pose.eye); }

} // namespace

TEST_CASE("flying moves along the view's axes and carries target and centre along") {
    const Pose forward = fly(kStart, 0, 0, 2);
    CHECK(near(forward.eye, {0, 1, 3}));
    CHECK(near(forward.target, {0, 1, -2}));
    CHECK(near(forward.centre, {0, 1, -2}));
    CHECK(near(fly(kStart, 1, 0, 0).eye, {1, 1, 5}));
    CHECK(near(fly(kStart, 0, 1, 0).eye, {0, 2, 5}));
}

TEST_CASE("orbiting keeps the distance, and dragging right brings the left into view") {
    const Pose turned = orbit(kStart, 0.25f, 0);
    CHECK(length(turned.eye - turned.centre) == doctest::Approx(5));
    CHECK(near(turned.centre, kStart.centre, 1e-6f));
    CHECK(turned.eye.x < -1);                // the eye moves left, so the scene moves right
    CHECK(orbit(kStart, 0, 0.1f).eye.y > 1); // dragging down shows the scene from above
    Pose aside = kStart;
    aside.centre = {1, 1, 1}; // about a point off the view's axis the view turns without a jump
    const Pose moved = orbit(aside, 0.1f, 0.05f);
    CHECK(length(moved.eye - moved.centre) == doctest::Approx(length(aside.eye - aside.centre)));
    CHECK(length(moved.target - moved.eye) == doctest::Approx(5));
    CHECK(near(orbit(aside, 0, 0).eye, aside.eye));
}

TEST_CASE("looking around turns about the eye by the dragged angle, and to the right when dragged right") {
    const float fov = 1;
    const Pose turned = turn(kStart, 0.3f, 0, fov);
    CHECK(near(turned.eye, kStart.eye, 1e-6f));
    CHECK(ahead(turned).x == doctest::Approx(std::sin(0.3)));
    CHECK(near(turned.centre, turned.target, 1e-6f));
    CHECK(ahead(turn(kStart, 0, 0.2f, fov)).y == doctest::Approx(-std::sin(0.2)));
}

TEST_CASE("no drag passes the poles") {
    Pose pose = kStart;
    for (int i = 0; i < 50; ++i) pose = orbit(pose, 0.01f, 0.3f);
    CHECK(ahead(pose).y == doctest::Approx(-std::sin(1.55334)).epsilon(1e-4));
    for (int i = 0; i < 50; ++i) pose = turn(pose, 0, -0.9f, 1);
    CHECK(ahead(pose).y == doctest::Approx(std::sin(1.55334)).epsilon(1e-4));
    const Transform placed = look_at(pose.eye, pose.target, pose.up);
    CHECK(is_finite(placed.row0));
}

TEST_CASE("panning keeps points at the centre's distance under the pointer, and zooming never reaches the centre") {
    Camera camera;
    camera.fov_y = 1;
    const Pose panned =
        pan(kStart, 0.5f, 0, view_height_at(camera, 5)); // drags to the right by half a picture's height
    CHECK(panned.eye.x == doctest::Approx(-5 * std::tan(0.5)));
    CHECK(near(ahead(panned), ahead(kStart)));
    camera.projection = Projection::Orthographic, camera.ortho_height = 3;
    CHECK(pan(kStart, 0, 0.5f, view_height_at(camera, 5)).eye.y == doctest::Approx(1 + 1.5));
    CHECK(length(zoom(kStart, 1).eye - kStart.centre) == doctest::Approx(5 * 6.0 / 7));
    CHECK(length(zoom(kStart, -1).eye - kStart.centre) == doctest::Approx(5 * 7.0 / 6));
    Pose near_centre = kStart;
    for (int i = 0; i < 20; ++i) near_centre = zoom(near_centre, 20);
    CHECK(is_finite(look_at(near_centre.eye, near_centre.target, near_centre.up).row0));
}

TEST_CASE("Shift is fast, Z is slow, and motion is proportional to time") {
    ClientMessage message;
    message.seconds = 0.1f;
    CHECK(metres_of(message, 2) == doctest::Approx(0.2));
    message.pace = Pace::Fast;
    CHECK(metres_of(message, 2) == doctest::Approx(0.8));
    message.pace = Pace::Slow;
    CHECK(metres_of(message, 2) < 0.1f);
}

TEST_CASE("a pose made from a camera keeps requested values and a leaning camera's roll") {
    Camera camera;
    camera.world_from_camera = look_at({1, 2, 3}, {0, 0, 0}, {0, 1, 0});
    const Pose pose = pose_of(camera, {}, {}, 2);
    CHECK(pose.up == Vec3{0, 1, 0});
    CHECK(length(pose.target - pose.eye) == doctest::Approx(2));
    CHECK(near(ahead(pose), normalize(Vec3{-1, -2, -3})));
    CHECK(pose_of(camera, Vec3{0, 0, 0}, {}, 2).target == Vec3{0, 0, 0});
    camera.world_from_camera = look_at({1, 2, 3}, {0, 0, 0}, {0.3f, 1, 0});
    CHECK(pose_of(camera, {}, {}, 2).up != Vec3{0, 1, 0});
}

TEST_CASE("angles become degrees for the command line that reproduce them to the bit") {
    test::Random random(11);
    int exact = 0;
    constexpr int kRounds = 1000;
    for (int i = 0; i < kRounds; ++i) {
        const float degrees = random.within(1, 170), radians = degrees * (kPi / 180.0f);
        exact += degrees_for(radians) * (kPi / 180.0f) == radians ? 1 : 0;
    }
    CHECK(exact == kRounds); // each of these angles is a number of degrees
}

TEST_CASE("flags contain eye, target and lens") {
    Camera camera;
    camera.fov_y = 50 * (kPi / 180.0f);
    CHECK(camera_flags(kStart, camera, "") == "--eye 0,1,5 --target 0,1,0 --fov 50");
    camera.aperture_radius = 0.5f;
    camera.focus_distance = 4;
    Pose leaning = kStart;
    leaning.up = {0, 0, 1};
    CHECK(camera_flags(leaning, camera, "main") ==
          "--camera main --eye 0,1,5 --target 0,1,0 --up 0,0,1 --fov 50 --aperture 0.5 --focus 4");
    CHECK(camera_flags(kStart, camera, "it's").starts_with("--camera 'it'\\''s' --eye 0,1,5 ")); // quoted for a shell
    camera.projection = Projection::Orthographic;
    CHECK(camera_flags(kStart, camera, "").find("--projection orthographic --view-height 2") != std::string::npos);
}

TEST_CASE("a camera through a point of the picture looks in that pixel's direction") {
    Camera camera;
    camera.world_from_camera = look_at({1, 2, 3}, {0, 0.5f, 0}, {0, 1, 0});
    camera.aperture_radius = 0.1f;
    for (const Projection projection : {Projection::Perspective, Projection::Orthographic}) {
        camera.projection = projection;
        const CameraView view = make_camera_view(camera, 400, 300);
        for (const auto& [x, y] : {std::pair{0.5f, 0.5f}, {0.1f, 0.8f}, {1.0f, 0.0f}}) {
            Camera pinhole = camera;
            pinhole.aperture_radius = 0;
            const Ray expected = make_camera_ray(make_camera_view(pinhole, 400, 300), {x * 400, y * 300}, {0, 0});
            const Camera through = camera_through(camera, 4.0f / 3, x, y);
            const Ray ray = make_camera_ray(make_camera_view(through, 1, 1), {0.5f, 0.5f}, {0, 0});
            CHECK(near(ray.origin, expected.origin));
            CHECK(near(ray.direction, expected.direction));
        }
        CHECK(view.aperture_radius > 0);
    }
}
