// Panoramas as lenses: known directions, inverse, density and seams.

#include "render/panorama.h"

#include <doctest/doctest.h>

#include "render/camera_view.h"
#include "render/connect_to_camera.h"

using namespace pertev;

namespace {

constexpr uint32_t kPanoramaHeight = 64;

CameraView panorama_view(LensModel lens) {
    Camera camera;
    camera.lens = lens;
    return make_camera_view(camera, (lens == LensModel::Cube ? 6 : 2) * kPanoramaHeight, kPanoramaHeight);
}

bool points_to(Vec3 a, Vec3 b) { return length(normalize(a) - normalize(b)) < 1e-5f; }

} // namespace

TEST_CASE("an equirectangular picture has -z in its middle, x to the right of it and y at its top") {
    const CameraView view = panorama_view(LensModel::Equirectangular);
    const auto towards = [&](float x, float y) { return make_camera_ray(view, {x, y}, {0, 0}).direction; };
    CHECK(points_to(towards(64, 32), {0, 0, -1}));
    CHECK(points_to(towards(96, 32), {1, 0, 0}));
    CHECK(points_to(towards(32, 32), {-1, 0, 0}));
    CHECK(points_to(towards(0, 32), {0, 0, 1}));
    CHECK(points_to(towards(128, 32), {0, 0, 1})); // both borders meet
    CHECK(points_to(towards(64, 0), {0, 1, 0}));
    CHECK(points_to(towards(64, 16), {0, 1, -1}));
    CHECK(points_to(towards(-2, 20), towards(126, 20))); // filters reach beyond the borders
    CHECK(points_to(towards(30, -3), towards(94, 3)));
}

TEST_CASE("each face of a cube shows what a camera with an angle of 90 degrees sees") {
    const CameraView view = panorama_view(LensModel::Cube);
    Camera front;
    front.fov_y = 0.5f * kPi;
    const CameraView face = make_camera_view(front, kPanoramaHeight, kPanoramaHeight);
    // Columns of the rotations: right, up, back.
    const Vec3 axes[6][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},   {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}},
                             {{-1, 0, 0}, {0, 1, 0}, {0, 0, -1}}, {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}},
                             {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}},  {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};
    for (int f = 0; f < 6; ++f) {
        CAPTURE(f);
        for (const Vec2 at : {Vec2{32, 32}, {3.5f, 20}, {60, 61}, {32, 1}}) {
            const Vec3 d = make_camera_ray(face, at, {0, 0}).direction;
            const Vec3 turned = d.x * axes[f][0] + d.y * axes[f][1] + d.z * axes[f][2];
            const Vec2 in_row = {at.x + static_cast<float>(f) * kPanoramaHeight, at.y};
            CHECK(points_to(make_camera_ray(view, in_row, {0, 0}).direction, turned));
        }
    }
}

TEST_CASE("positions in a panorama invert its rays, and their growth is that of areas over solid angles") {
    for (const LensModel lens : {LensModel::Equirectangular, LensModel::Cube}) {
        const CameraView view = panorama_view(lens);
        CAPTURE(static_cast<int>(lens));
        double covered = 0;
        for (float y = 0.5f; y < kPanoramaHeight; y += 1) {
            for (float x = 0.5f; x < 1 / view.inv_width; x += 1) {
                const Vec3 d = make_camera_ray(view, {x, y}, {0, 0}).direction;
                const ProjectedPoint back = project_point(view, 3.0f * d);
                REQUIRE(back.pixel.x == doctest::Approx(x).epsilon(1e-4));
                REQUIRE(back.pixel.y == doctest::Approx(y).epsilon(1e-4));
                const float area = 4 * view.half_width * view.half_height * view.inv_width * view.inv_height;
                covered += static_cast<double>(area / panorama_position(lens, d).growth);
            }
        }
        CHECK(covered == doctest::Approx(4 * 3.14159265).epsilon(2e-3)); // the whole sphere
    }
}

TEST_CASE("a panorama has no coefficients and no angle of view") {
    for (const LensModel lens : {LensModel::Equirectangular, LensModel::Cube}) {
        CHECK(is_panorama(lens));
        CHECK(sees_behind(lens));
        CHECK(takes_coefficients(lens, 0));
        CHECK_FALSE(takes_coefficients(lens, 4));
        Camera camera;
        camera.lens = lens, camera.fov_y = 0.1f;
        CHECK(make_camera_view(camera, 640, 480).half_height == panorama_half_size(lens).y);
        CHECK_FALSE(has_straight_lens(camera));
    }
    CHECK_FALSE(is_panorama(LensModel::Fisheye));
}
