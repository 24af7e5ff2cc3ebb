// Distorting lenses, compared with results of OpenCV 5.0 (cv2.projectPoints, cv2.undistortPoints,
// cv2.fisheye.projectPoints) for the same points, with y and z turned to its axes.

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "math/double_vec3.h"
#include "math/lanes.h"
#include "render/connect_to_camera.h"
#include "tests/support/calibrations.h"
#include "tests/support/random.h"

using namespace pertev;
using test::Calibration, test::camera_of, test::kCalibrations, test::kPoints;

namespace {

CameraRays rays_of(const Camera& camera) {
    return make_camera_rays(camera, {PixelFilter::Box, 0.5f, nullptr}, 1280, 720, {0, 0, 0});
}

} // namespace

TEST_CASE("a lens projects points where OpenCV does, at every size of the picture") {
    for (const Calibration& calibration : kCalibrations) {
        CAPTURE(calibration.name);
        const Camera camera = camera_of(calibration);
        for (const uint32_t scale : {1u, 4u}) {
            const CameraView view = make_camera_view(camera, 1280 / scale, 720 / scale);
            for (int i = 0; i < 6; ++i) {
                CAPTURE(i);
                const ProjectedPoint seen = project_point(view, kPoints[i]);
                const float s = static_cast<float>(scale);
                CHECK(std::abs(seen.pixel.x * s - calibration.seen[i].x) < 1e-3f);
                CHECK(std::abs(seen.pixel.y * s - calibration.seen[i].y) < 1e-3f);
                CHECK(seen.depth == -kPoints[i].z);
            }
        }
    }
}

TEST_CASE("a lens maps pixels to the directions that OpenCV computes") {
    struct Undistorted {
        Vec2 pixel, at;
    };
    constexpr Undistorted kOfFour[] = {{{100, 80}, {-0.7145951f, -0.3197873f}},
                                       {{640, 360}, {-0.0111114f, 0.0101011f}},
                                       {{1200, 700}, {0.7313674f, 0.4220056f}},
                                       {{30, 650}, {-0.8463111f, 0.3714585f}}};
    const CameraView view = make_camera_view(camera_of(kCalibrations[0]), 1280, 720);
    for (const Undistorted& expected : kOfFour) {
        const Vec3 seen = make_camera_ray(view, expected.pixel, {}).direction;
        CHECK(seen.x / -seen.z == doctest::Approx(expected.at.x).epsilon(1e-5));
        CHECK(seen.y / seen.z == doctest::Approx(expected.at.y).epsilon(1e-5));
    }
}

TEST_CASE("projecting a pixel's point returns the pixel, and lanes have the same bits") {
    test::Random random(3);
    for (const Calibration& calibration : kCalibrations) {
        CAPTURE(calibration.name);
        const CameraRays rays = rays_of(camera_of(calibration));
        uint32_t seen = 0;
        for (int i = 0; i < 4000; ++i) {
            const float x = 1280 * random.unit(), y = 720 * random.unit();
            const Ray ray = make_camera_ray(rays.view, {x, y}, {});
            const RayLineOf<Floats8> lanes = make_camera_line(rays.view, Vec2Of<Floats8>{x, y}, Vec2Of<Floats8>{});
            CHECK(lanes.origin.x[5] == ray.origin.x);
            CHECK(lanes.direction.x[0] == ray.direction.x);
            CHECK(lanes.direction.y[3] == ray.direction.y);
            CHECK(lanes.direction.z[7] == ray.direction.z);
            if (is_outside_lens(ray.origin)) continue;
            ++seen;
            // Floats near 1280 are 1.2e-4 apart, and where a lens is barely monotone, angles change fast.
            const ProjectedPoint at = project_point(rays.view, 3.0f * ray.direction);
            CHECK(std::abs(at.pixel.x - x) < 0.02f);
            CHECK(std::abs(at.pixel.y - y) < 0.02f);
            CameraConnection connected;
            REQUIRE(connect_to_camera(rays, 3.0f * ray.direction, {}, connected));
            CHECK(std::abs(connected.raster.x - at.pixel.x) < 4e-4f);
            CHECK(std::abs(connected.raster.y - at.pixel.y) < 4e-4f);
        }
        CHECK(seen > 3900);
    }
}

TEST_CASE("round trips through a small picture stay within 1e-4 pixels") {
    test::Random random(5);
    for (int k : {0, 1, 3}) {
        const CameraView view = make_camera_view(camera_of(kCalibrations[k]), 160, 90);
        for (int i = 0; i < 1000; ++i) {
            const float x = 160 * random.unit(), y = 90 * random.unit();
            const ProjectedPoint at = project_point(view, 3.0f * make_camera_ray(view, {x, y}, {}).direction);
            CHECK(std::abs(at.pixel.x - x) < 1e-4f);
            CHECK(std::abs(at.pixel.y - y) < 1e-4f);
        }
    }
}

TEST_CASE("a lens shows nothing where its model is no longer monotone") {
    Camera barrel;
    barrel.lens = LensModel::OpenCv;
    barrel.distortion = {-0.3, 0, 0, 0}; // r - 0.3 r^3 turns back at r = 1 / sqrt(0.9), where it is 0.7027
    barrel.intrinsics = Intrinsics{100, 100, 100, 100, 200, 200};
    const CameraView view = make_camera_view(barrel, 200, 200);
    CHECK(view.lens.limit == doctest::Approx(1 / std::sqrt(0.9)).epsilon(1e-5));
    CHECK_FALSE(is_outside_lens(make_camera_ray(view, {170, 100}, {}).origin));
    CHECK(is_outside_lens(make_camera_ray(view, {170.6f, 100}, {}).origin));
    CHECK(is_outside_lens(make_camera_ray(view, {199, 199}, {}).origin));
    CHECK(std::isnan(project_point(view, {1.2f, 0, -1}).pixel.x)); // the lens would show this direction a second time
    CameraConnection seen;
    CHECK_FALSE(connect_to_camera(rays_of(barrel), {1.2f, 0, -1}, {}, seen));
    CHECK(camera_density(rays_of(barrel), {}, normalize(Vec3{1.2f, 0, -1})) == 0);

    Camera fisheye = barrel;
    fisheye.lens = LensModel::Fisheye;
    fisheye.distortion = {-1 / 12.0, 0, 0, 0}; // stops being monotone at 2 radians, which is behind the camera
    CHECK(make_camera_view(fisheye, 200, 200).lens.limit == doctest::Approx(2));
    fisheye.distortion = {};
    const CameraView equidistant = make_camera_view(fisheye, 200, 200);
    const Vec3 behind = make_camera_ray(equidistant, {100, 100 + 100 * 2.5f}, {}).direction; // 2.5 radians
    CHECK(behind.y == doctest::Approx(-std::sin(2.5)).epsilon(1e-5));
    CHECK(behind.z == doctest::Approx(-std::cos(2.5)).epsilon(1e-5));
    CHECK(is_outside_lens(make_camera_ray(equidistant, {100, 100 + 100 * 3.2f}, {}).origin));
    CHECK(project_point(equidistant, behind).pixel.y == doctest::Approx(350).epsilon(1e-5));
}

TEST_CASE("a fisheye without calibration has the requested angle of view across its height") {
    Camera camera;
    camera.lens = LensModel::Fisheye;
    camera.fov_y = 3;
    const Vec3 top = make_camera_ray(make_camera_view(camera, 320, 160), {160, 0}, {}).direction;
    CHECK(top.y == doctest::Approx(std::sin(1.5)).epsilon(1e-5));
}

TEST_CASE("the density of camera rays is that of pixels over solid angles") {
    for (const Calibration& calibration : kCalibrations) {
        for (const float aperture : {0.0f, 0.05f}) {
            if (aperture > 0 && calibration.lens == LensModel::Fisheye) continue;
            CAPTURE(calibration.name);
            CAPTURE(aperture);
            Camera camera = camera_of(calibration);
            camera.aperture_radius = aperture;
            camera.focus_distance = 2;
            const CameraRays rays = rays_of(camera);
            for (const Vec2 pixel : {Vec2{300, 200}, Vec2{650, 350}, Vec2{900, 600}, Vec2{1100, 100}}) {
                const Vec2 lens = {0.8f, 0.3f};
                const auto direction = [&](float x, float y) {
                    return to_double(make_camera_line(rays.view, Vec2{pixel.x + x, pixel.y + y}, lens).direction);
                };
                const DoubleVec3 right = direction(4, 0) - direction(-4, 0), down = direction(0, 4) - direction(0, -4);
                const DoubleVec3 area = cross(right, down);
                const double solid_angle = std::sqrt(dot(area, area)) / 64; // solid angle of a pixel
                const Ray ray = make_camera_ray(rays.view, pixel, lens);
                const float density = camera_density(rays, ray.origin, ray.direction);
                CHECK(density == doctest::Approx(1 / (1280 * 720 * solid_angle)).epsilon(2e-3));
            }
        }
    }
}

TEST_CASE("a lens with the coefficients 0 is straight, to the bit") {
    Camera camera;
    const CameraView plain = make_camera_view(camera, 64, 36);
    camera.lens = LensModel::OpenCv;
    camera.distortion = {0, 0, 0, 0, 0};
    const CameraView zero = make_camera_view(camera, 64, 36);
    CHECK(zero.lens.model == LensModel::Straight);
    CHECK(make_camera_ray(zero, {3.5f, 7.25f}, {}).direction == make_camera_ray(plain, {3.5f, 7.25f}, {}).direction);
}
