#include <algorithm>
#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "render/camera_view.h"
#include "scene/projection_features.h"
#include "tests/support/meshes.h"

using namespace pertev;

namespace {

/// A camera away from the origin, rotated about all axes.
Camera placed_camera() {
    Camera camera;
    camera.world_from_camera = look_at({3, -2, 5}, {-1, 0.5f, 0.25f}, {0.3f, 1, -0.2f});
    camera.fov_y = 1.1f;
    return camera;
}

Vec3 in_camera_space(const Camera& camera, Vec3 point) {
    return transform_point(inverse(camera.world_from_camera), point);
}

Vec3 direction_in_camera_space(const Camera& camera, Vec3 direction) {
    return transform_vector(inverse(camera.world_from_camera), direction);
}

double distance(Vec3 a, Vec3 b) { return static_cast<double>(length(a - b)); }

} // namespace

TEST_CASE("a pinhole camera's rays start at the camera and have unit directions and no end") {
    const Camera camera = placed_camera();
    const CameraView view = make_camera_view(camera, 640, 360);
    for (const Vec2 pixel : {Vec2{0, 0}, Vec2{320, 180}, Vec2{640, 360}, Vec2{12.25f, 300.5f}}) {
        const Ray ray = make_camera_ray(view, pixel, {0.9f, 0.1f});
        CHECK(distance(ray.origin, {3, -2, 5}) < 1e-6);
        CHECK(length(ray.direction) == doctest::Approx(1).epsilon(1e-6));
        CHECK(ray.t_min == 0);
        CHECK(ray.t_max == kInfinity);
    }
}

TEST_CASE("the ray of the picture's centre follows the camera's axis, with up and right as defined") {
    const Camera camera = placed_camera();
    const CameraView view = make_camera_view(camera, 640, 360);
    const Vec3 middle = make_camera_ray(view, {320, 180}, {}).direction;
    CHECK(distance(middle, normalize(Vec3{-4, 2.5f, -4.75f})) < 1e-6);
    CHECK(direction_in_camera_space(camera, make_camera_ray(view, {320, 10}, {}).direction).y > 0.1f);
    CHECK(direction_in_camera_space(camera, make_camera_ray(view, {600, 180}, {}).direction).x > 0.1f);
}

TEST_CASE("the field of view applies to the height for any aspect, and pixels are square") {
    Camera camera = placed_camera();
    camera.aspect = 2.5f; // the file's aspect determines the size of a picture, not the view of a given one
    const double tangent = std::tan(0.55);
    struct Size {
        uint32_t width, height;
    };
    for (const Size size : {Size{640, 360}, Size{360, 640}, Size{100, 100}}) {
        CAPTURE(size.width);
        const CameraView view = make_camera_view(camera, size.width, size.height);
        const auto width = static_cast<float>(size.width), height = static_cast<float>(size.height);
        const Vec3 top = direction_in_camera_space(camera, make_camera_ray(view, {0.5f * width, 0}, {}).direction);
        const Vec3 bottom =
            direction_in_camera_space(camera, make_camera_ray(view, {0.5f * width, height}, {}).direction);
        const Vec3 right =
            direction_in_camera_space(camera, make_camera_ray(view, {width, 0.5f * height}, {}).direction);
        CHECK(top.y / -top.z == doctest::Approx(tangent).epsilon(1e-5));
        CHECK(bottom.y / -bottom.z == doctest::Approx(-tangent).epsilon(1e-5));
        CHECK(right.x / -right.z == doctest::Approx(tangent * size.width / size.height).epsilon(1e-5));
    }
}

TEST_CASE("with a thin lens all rays of a pixel meet in the focus plane and cover the whole lens") {
    Camera camera = placed_camera();
    camera.aperture_radius = 0.25f;
    camera.focus_distance = 4;
    const CameraView view = make_camera_view(camera, 640, 360);
    camera.aperture_radius = 0;
    const CameraView pinhole = make_camera_view(camera, 640, 360);
    test::Random random(5);
    for (const Vec2 pixel : {Vec2{320, 180}, Vec2{3, 350}, Vec2{639.5f, 0.5f}}) {
        const Ray sharp = make_camera_ray(pinhole, pixel, {});
        const float along = -direction_in_camera_space(camera, sharp.direction).z;
        const Vec3 focus = sharp.origin + (4 / along) * sharp.direction;
        double widest = 0;
        for (int i = 0; i < 2000; ++i) {
            const float u = random.unit(), v = random.unit();
            const Ray ray = make_camera_ray(view, pixel, {u, v});
            const Vec3 start = in_camera_space(camera, ray.origin);
            CHECK(abs(start.z) < 2e-6f);
            widest = std::max(widest, std::hypot(double(start.x), double(start.y)));
            const float t = 4 / -direction_in_camera_space(camera, ray.direction).z;
            CHECK(distance(ray.origin + t * ray.direction, focus) < 1e-5);
        }
        CHECK(widest <= 0.25 * (1 + 1e-5));
        CHECK(widest > 0.245);
    }
}

TEST_CASE("blades make the lens a regular polygon that turns with its rotation and narrows with its ratio") {
    struct Shape {
        uint32_t blades;
        float rotation_deg, ratio;
    };
    for (const Shape shape : {Shape{3, 0, 1}, Shape{5, 100, 2}, Shape{6, -30, 0.5f}, Shape{0, 20, 2}}) {
        CAPTURE(shape.blades);
        Camera camera;
        camera.aperture_radius = 0.25f;
        camera.aperture = {shape.blades, shape.rotation_deg, shape.ratio};
        const CameraView view = make_camera_view(camera, 64, 64);
        const auto start = [&](float u, float v) {
            const Vec3 from = make_camera_ray(view, {32, 32}, {u, v}).origin;
            return Vec2{4 * shape.ratio * from.x, 4 * from.y}; // in the unit circle
        };
        const double step = 2 * std::numbers::pi / std::max(shape.blades, 3u);
        const double apothem = shape.blades > 0 ? std::cos(0.5 * step) : 1;
        std::vector<double> farthest(std::max(shape.blades, 3u)), corners = farthest;
        double longest_step = 0;
        for (int i = 0; i <= 400; ++i) {
            for (int k = 0; k <= 400; ++k) {
                const float u = static_cast<float>(i) / 400, v = static_cast<float>(k) / 400;
                const Vec2 at = start(u, v);
                for (std::size_t side = 0; side < farthest.size(); ++side) {
                    const double angle = double(shape.rotation_deg) * std::numbers::pi / 180 + double(side) * step;
                    const auto along = [&](double a) {
                        return double(at.x) * std::cos(a) + double(at.y) * std::sin(a);
                    };
                    farthest[side] = std::max(farthest[side], along(angle));
                    corners[side] = std::max(corners[side], along(angle + 0.5 * step));
                }
                if (i == 400 || k == 400) continue;
                for (const Vec2 near : {start(u + 0.0025f, v), start(u, v + 0.0025f)})
                    longest_step = std::max(longest_step, std::hypot(double(near.x - at.x), double(near.y - at.y)));
            }
        }
        for (const double reach : farthest) CHECK(reach == doctest::Approx(apothem).epsilon(1e-4));
        for (const double reach : corners) CHECK(reach == doctest::Approx(1).epsilon(0.01));
        CHECK(longest_step < 4 * 0.0025 * 1.5); // near points stay near
    }
}

TEST_CASE("orthographic rays are parallel, and the view has the requested height") {
    Camera camera = placed_camera();
    camera.projection = Projection::Orthographic;
    camera.ortho_height = 3;
    const CameraView view = make_camera_view(camera, 800, 400);
    const Vec3 axis = normalize(Vec3{-4, 2.5f, -4.75f});
    for (const Vec2 pixel : {Vec2{0, 0}, Vec2{800, 400}, Vec2{100, 300}}) {
        const Ray ray = make_camera_ray(view, pixel, {});
        CHECK(distance(ray.direction, axis) < 1e-6);
        const Vec3 start = in_camera_space(camera, ray.origin);
        CHECK(static_cast<double>(start.x) == doctest::Approx(6.0 * double(pixel.x) / 800 - 3).epsilon(1e-5));
        CHECK(static_cast<double>(start.y) == doctest::Approx(1.5 - 3.0 * double(pixel.y) / 400).epsilon(1e-5));
        CHECK(abs(start.z) < 2e-6f);
    }
}

TEST_CASE("an orthographic lens keeps the focus plane sharp") {
    Camera camera = placed_camera();
    camera.projection = Projection::Orthographic;
    camera.ortho_height = 3;
    camera.aperture_radius = 0.5f;
    camera.focus_distance = 2;
    const CameraView view = make_camera_view(camera, 800, 400);
    camera.aperture_radius = 0;
    const Ray sharp = make_camera_ray(make_camera_view(camera, 800, 400), {150, 90}, {});
    const Vec3 focus = sharp.origin + 2.0f * sharp.direction;
    for (const Vec2 lens : {Vec2{0.01f, 0.5f}, Vec2{0.5f, 0.99f}, Vec2{0.7f, 0.2f}}) {
        const Ray ray = make_camera_ray(view, {150, 90}, lens);
        CHECK(distance(ray.origin, sharp.origin) > 0.1);
        const float t = 2 / -direction_in_camera_space(camera, ray.direction).z;
        CHECK(distance(ray.origin + t * ray.direction, focus) < 1e-5);
    }
}

TEST_CASE("a number in a file is the projection of a picture's camera, or it is none") {
    CHECK(projection_of_picture(0) == Projection::Perspective);
    CHECK(projection_of_picture(1) == Projection::Orthographic);
    for (const uint32_t number : {2u, 3u, 255u, 256u, 257u, 0x80000000u}) CHECK(!projection_of_picture(number));
    CHECK(has_angle_of_view(Projection::Perspective));
    CHECK(!has_angle_of_view(Projection::Orthographic));
}
