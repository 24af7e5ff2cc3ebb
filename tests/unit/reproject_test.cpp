#include <cmath>
#include <doctest/doctest.h>

#include "denoise/reproject.h"
#include "denoise/shown_color.h"

using namespace pertev;

namespace {

Camera camera_at(Vec3 eye, Projection projection = Projection::Perspective) {
    Camera camera;
    camera.projection = projection;
    camera.world_from_camera = look_at(eye, eye + Vec3{0.2f, -0.1f, -1}, {0, 1, 0});
    return camera;
}

} // namespace

TEST_CASE("reprojecting a pixel's point returns the pixel") {
    for (const Projection projection : {Projection::Perspective, Projection::Orthographic}) {
        const CameraView view = make_camera_view(camera_at({1, 2, 3}, projection), 640, 360);
        for (const Vec2 pixel : {Vec2{320, 180}, Vec2{0.5f, 0.5f}, Vec2{600.25f, 100.75f}}) {
            const Ray ray = make_camera_ray(view, pixel, {0, 0});
            const ProjectedPoint seen = project_point(view, ray.origin + 4.0f * ray.direction);
            CHECK(seen.pixel.x == doctest::Approx(pixel.x).epsilon(1e-4));
            CHECK(seen.pixel.y == doctest::Approx(pixel.y).epsilon(1e-4));
            const Vec3 there = transform_point(view.world_from_camera, unproject_point(view, pixel, seen.depth));
            CHECK(length(there - (ray.origin + 4.0f * ray.direction)) < 1e-4f);
        }
    }
}

TEST_CASE("a virtual point at distance 0 behind the surface moves with the surface") {
    const FrameCameras cameras = {make_camera_view(camera_at({1, 2, 3}), 640, 360),
                                  make_camera_view(camera_at({1.1f, 2, 3}), 640, 360), 640, 360};
    const Vec2 pixel = {200.5f, 90.5f};
    const Vec3 point = transform_point(cameras.now.world_from_camera, unproject_point(cameras.now, pixel, 5));
    const ProjectedPoint then = project_point(cameras.before, point);
    const Reprojection same = reproject_virtual(cameras, pixel, 5, 0);
    CHECK(same.pixel.x == doctest::Approx(then.pixel.x).epsilon(1e-4));
    CHECK(same.pixel.y == doctest::Approx(then.pixel.y).epsilon(1e-4));
    CHECK(same.depth == doctest::Approx(then.depth).epsilon(1e-4));
    // A point farther behind the mirror moves less.
    const Reprojection far = reproject_virtual(cameras, pixel, 5, 1000);
    CHECK(std::abs(far.pixel.x - pixel.x) < 0.02f * std::abs(same.pixel.x - pixel.x) + 0.01f);
}

TEST_CASE("reprojection follows moved objects") {
    const Vec3 positions[] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    const uint32_t indices[] = {0, 1, 2};
    const MeshView mesh = {.positions = positions,
                           .normals = nullptr,
                           .tangents = nullptr,
                           .uv = {},
                           .colors = nullptr,
                           .indices = indices};
    InstanceView now = {}, before = {};
    now.world_from_local.translation = {0.5f, 0, 0};
    SceneView scene = {};
    scene.instances = &now;
    scene.meshes = &mesh;
    Camera camera;
    camera.world_from_camera = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0});
    const CameraView view = make_camera_view(camera, 640, 360);
    const FrameCameras cameras = {view, view, 640, 360};
    const Float4 place = {float_of(0), float_of(0), 0.25f, 0.5f}; // the centre of the triangle
    const Vec2 centre = project_point(view, point_at(&now, &mesh, place)).pixel;
    const Reprojection moved = reproject_surface(cameras, scene, {&before, &mesh}, centre, place);
    const float pixels = 0.5f / (5 * view.half_width) * 0.5f * 640; // half a metre at 5 m
    CHECK(moved.pixel.x == doctest::Approx(centre.x - pixels).epsilon(1e-4));
    CHECK(moved.pixel.y == doctest::Approx(centre.y));
    CHECK(moved.depth == doctest::Approx(5));
    const Reprojection still = reproject_surface(cameras, scene, {&now, &mesh}, centre, place);
    CHECK(still.pixel.x == doctest::Approx(centre.x));
}

TEST_CASE("packed guides keep the precision that filters need") {
    const Vec3 normals[] = {{0, 0, 1}, {-1, 0, 0}, normalize(Vec3{1, 2, -3}), {0, 0, 0}};
    for (const Vec3 n : normals) {
        for (const float alpha : {0.0f, 0.002f, 0.3f, 1.0f}) {
            const Float4 packed = pack({n, alpha, 12.345f, kNoHit - 1});
            CHECK(length(normal_of(packed) - n) < 3e-5f);
            CHECK(alpha_of(packed) == doctest::Approx(alpha).epsilon(1e-5));
            CHECK(depth_of(packed) == 12.345f);
            CHECK(object_of(packed) == kNoHit - 1);
        }
    }
    CHECK(length(normal_of(pack({{0, 0, 0}, 1, 0, kNoHit}))) == 0);
}

TEST_CASE("displayed colours convert back to light within rounding") {
    for (const Rgb light :
         {Rgb{0, 0, 0}, Rgb{1e-4f, 2e-4f, 0}, Rgb{1, 0.5f, 0.25f}, Rgb{0, 0, 300}, Rgb{4e4f, 3e4f, 1e4f}}) {
        const Rgb back = light_of_shown(shown_color(light));
        const float error =
            (1e-6f + 1e-6f * luminance(light)) * luminance(light); // 1 - Y loses digits where Y is near 1
        CHECK(std::abs(back.r - light.r) <= 2 * error);
        CHECK(std::abs(back.g - light.g) <= 2 * error);
        CHECK(std::abs(back.b - light.b) <= 12 * error);
    }
}

TEST_CASE("taps accept only the same object at a similar depth and normal") {
    constexpr uint32_t kWidth = 4, kHeight = 3;
    std::vector<Float4> guide(kWidth * kHeight, pack({{0, 0, 1}, 1, 2, 7}));
    std::vector<Float4> values(kWidth * kHeight);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = {static_cast<float>(i), 0, 0, 1};
    HistoryView before = {};
    before.guide = guide.data();
    const FrameCameras cameras = {{}, {}, kWidth, kHeight};
    const auto taps_at = [&](Vec2 place, float depth = 2, Vec3 n = {0, 0, 1}, uint32_t id = 7) {
        return find_taps(before, cameras, place, depth, n, kMinNormalCosine, id);
    };

    const Taps all = taps_at({2, 1.5f}); // between pixels 1 and 2 of row 1
    CHECK(all.sum == doctest::Approx(1));
    CHECK(mean_of_taps(all, cameras, values.data()).x == doctest::Approx(5.5f));
    CHECK(taps_at({2, 1.5f}, 2.2f).sum == 0);            // the pixel is outside the picture
    CHECK(taps_at({2, 1.5f}, 2, {1, 0, 0}).sum == 0);    // the normal faces away
    CHECK(taps_at({2, 1.5f}, 2, {0, 0, 1}, 8).sum == 0); // another object
    const Vec3 bent = normalize(Vec3{0.03f, 0, 1});      // a curved mirror
    CHECK(taps_at({2, 1.5f}, 0, bent).sum == doctest::Approx(1));
    CHECK(find_taps(before, cameras, {2, 1.5f}, 0, bent, 0.9999f, 7).sum == 0);
    CHECK(taps_at({-3, 1.5f}).sum == 0); // all taps are outside the picture
    CHECK(taps_at({1e30f, kInfinity}).sum == 0);
    CHECK(taps_at({-0.25f, 1.5f}).sum == doctest::Approx(0.25f)); // partly
    guide[5] = pack({{0, 0, 1}, 1, 2, 9});
    const Taps one = taps_at({2, 1.5f});
    CHECK(one.sum == doctest::Approx(0.5f));
    CHECK(mean_of_taps(one, cameras, values.data()).x == doctest::Approx(6));
    guide[6] = guide[5];
    const Taps beside = taps_at({1.75f, 1.5f}); // the nearest pixel is 5; of its neighbours 4 is the first after 6
    CHECK(beside.sum == 1);
    CHECK(mean_of_taps(beside, cameras, values.data()).x == doctest::Approx(4));
}
