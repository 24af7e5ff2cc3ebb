// Pictures through distorting lenses are the same by every schedule and device, show features where OpenCV projects
// them, and are black outside the lens's image. With --device cuda a GPU renders, too.

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>

#include "session/session.h"
#include "tests/support/calibrations.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

Camera through(Camera camera, LensModel lens, std::vector<double> distortion) {
    camera.lens = lens;
    camera.distortion = std::move(distortion);
    return camera;
}

/// Lenses over the mixed scene: OpenCV's model with and without a black rim and with blades, and a fisheye whose
/// corners are black.
std::vector<Camera> lenses() {
    const Camera plain = test::mixed_scene_camera();
    std::vector<Camera> all = {through(plain, LensModel::OpenCv, {-0.2, 0.05, 0.01, -0.02}),
                               through(plain, LensModel::OpenCv, {-0.9, 0, 0, 0}),
                               through(plain, LensModel::Fisheye, {0.1, -0.05, 0.02, -0.004})};
    all.push_back(all[0]);
    all.back().aperture_radius = 0.1f;
    all.back().aperture = {.blades = 5, .rotation_deg = 20, .ratio = 1.5f};
    all[2].intrinsics = Intrinsics{10, 12, 15, 11, 37, 21};
    return all;
}

RenderSettings small_settings() {
    RenderSettings settings;
    settings.width = 37, settings.height = 21, settings.samples = 3;
    settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds | kAovDistance;
    settings.transparent = true;
    return settings;
}

/// Returns whether a point of the unit square lies between the blades of an aperture of ratio 1.
bool is_in_blades(const ApertureShape& shape, double x, double y) {
    const double step = 2 * std::numbers::pi / shape.blades;
    for (uint32_t i = 0; i < shape.blades; ++i) {
        const double angle = double(shape.rotation_deg) * std::numbers::pi / 180 + i * step;
        if (x * std::cos(angle) + y * std::sin(angle) > std::cos(0.5 * step)) return false;
    }
    return true;
}

/// The picture of a square of radiance 1 before the camera, focused at 1 m: the share of each pixel's rays,
/// from all points of the aperture, that meet it. By midpoints, in double precision.
Image expected_bokeh(const Camera& camera, double distance, double half_size, double half_view, uint32_t side) {
    constexpr int kPoints = 8, kLensPoints = 48;
    const ApertureShape& shape = camera.aperture;
    std::vector<double> lens; // x and y
    for (int i = 0; i < kLensPoints * kLensPoints; ++i) {
        const double x = 2 * (i % kLensPoints + 0.5) / kLensPoints - 1,
                     y = 2 * (i / kLensPoints + 0.5) / kLensPoints - 1;
        if (!is_in_blades(shape, x, y)) continue;
        const auto radius = double(camera.aperture_radius);
        lens.insert(lens.end(), {radius / double(shape.ratio) * x, radius * y});
    }
    Image picture = {side, side, 3, std::vector<float>(std::size_t(side) * side * 3)};
    for (uint32_t pixel = 0; pixel < side * side; ++pixel) {
        std::size_t hits = 0;
        for (int i = 0; i < kPoints * kPoints; ++i) {
            const double at_x = pixel % side + (i % kPoints + 0.5) / kPoints,
                         at_y = pixel / side + (i / kPoints + 0.5) / kPoints;
            const double x = (2 * at_x / side - 1) * half_view, y = (1 - 2 * at_y / side) * half_view;
            for (std::size_t k = 0; k < lens.size(); k += 2) {
                const double hit_x = lens[k] + distance * (x - lens[k]),
                             hit_y = lens[k + 1] + distance * (y - lens[k + 1]);
                hits += std::abs(hit_x) < half_size && std::abs(hit_y) < half_size ? 1 : 0;
            }
        }
        const auto share = static_cast<float>(2.0 * double(hits) / (kPoints * kPoints * double(lens.size())));
        for (int k = 0; k < 3; ++k) picture.pixels[3 * std::size_t(pixel) + std::size_t(k)] = share;
    }
    return picture;
}

} // namespace

TEST_CASE("a picture through a lens is the same by loop, wavefront and device, and lenses differ") {
    const Scene scene = test::make_mixed_scene();
    std::vector<Hash128> hashes;
    for (const Camera& camera : lenses()) {
        for (const IntegratorKind kind : {IntegratorKind::Path, IntegratorKind::Distributed,
                                          IntegratorKind::Bidirectional, IntegratorKind::Light}) {
            CAPTURE(static_cast<int>(kind));
            RenderSettings settings = small_settings();
            settings.integrator = kind;
            settings.path.max_depth = 4;
            Queue cpu = Queue::make_cpu();
            settings.body = PathBody::Loop;
            const Hash128 loop = test::render_hash(test::render(cpu, scene, camera, settings));
            settings.body = PathBody::Wavefront;
            Queue device = test::requested_queue();
            CHECK(test::render_hash(test::render(device, scene, camera, settings)) == loop);
            if (kind == IntegratorKind::Path) hashes.push_back(loop);
        }
    }
    for (std::size_t i = 0; i < hashes.size(); ++i) {
        for (std::size_t k = 0; k < i; ++k) CHECK(hashes[i] != hashes[k]);
    }
}

TEST_CASE("small emitters appear where OpenCV projects them, within a tenth of a pixel") {
    Scene scene;
    for (const Vec3 place : test::kPoints) {
        const float half = 0.005f * -place.z;
        test::add(scene, test::sheet(place, {half, 0, 0}, {0, half, 0}), {{.emission = {1, 1, 1}}, "lamp"});
    }
    Queue queue = test::requested_queue();
    for (const test::Calibration& calibration : {test::kCalibrations[0], test::kCalibrations[3]}) {
        const Camera camera = test::camera_of(calibration);
        RenderSettings settings;
        settings.width = 640, settings.height = 360, settings.samples = 64; // half of the calibrated size
        settings.filter = PixelFilter::Box;
        settings.path.max_depth = 0;
        for (int i = 0; i < 6; ++i) {
            CAPTURE(i);
            const double x = 0.5 * double(calibration.seen[i].x), y = 0.5 * double(calibration.seen[i].y);
            const PictureCrop crop = {uint32_t(x) - 8, uint32_t(y) - 8, 16, 16};
            settings.crop = crop;
            const Image picture = test::render(queue, scene, camera, settings).picture;
            double sum = 0, sum_x = 0, sum_y = 0;
            for (uint32_t row = 0; row < crop.height; ++row) {
                for (uint32_t column = 0; column < crop.width; ++column) {
                    const double light = double(picture.at(column, row)[0]);
                    sum += light, sum_x += light * (crop.x + column + 0.5), sum_y += light * (crop.y + row + 0.5);
                }
            }
            REQUIRE(sum > 3);
            CHECK(std::abs(sum_x / sum - x) < 0.1);
            CHECK(std::abs(sum_y / sum - y) < 0.1);
        }
    }
}

TEST_CASE("where a lens shows nothing, every integrator leaves black without alpha") {
    const Scene scene = test::make_furnace_scene(0.5f); // under an environment of radiance 1
    Camera camera = through({}, LensModel::OpenCv, {-0.9, 0, 0, 0});
    camera.world_from_camera = make_translation({0, 0, 6});
    camera.fov_y = 1.2f;
    Queue queue = test::requested_queue();
    for (const IntegratorKind kind :
         {IntegratorKind::Path, IntegratorKind::Whitted, IntegratorKind::Distributed, IntegratorKind::Light,
          IntegratorKind::Bidirectional, IntegratorKind::PhotonMap, IntegratorKind::IrradianceCache}) {
        CAPTURE(static_cast<int>(kind));
        RenderSettings settings = small_settings();
        settings.transparent = false;
        settings.integrator = kind;
        settings.path.max_depth = 2;
        settings.aovs = kAovIds | kAovDepth;
        const RenderResult result = test::render(queue, scene, camera, settings);
        CHECK(result.picture.at(0, 0)[0] == 0);
        CHECK(result.picture.at(36, 20)[1] == 0);
        CHECK(result.picture.at(14, 10)[1] == doctest::Approx(1).epsilon(1e-3)); // the background in the lens's image
        CHECK(result.ids.front().instance == kNoHit);
        CHECK(result.invalid_samples == 0);
        settings.transparent = true;
        CHECK(test::render(queue, scene, camera, settings).picture.at(0, 0)[3] == 0);
    }
}

TEST_CASE("light tracing and path tracing agree through a lens") {
    const Scene scene = test::floor_under_spot();
    Queue queue = test::requested_queue();
    for (const LensModel lens : {LensModel::OpenCv, LensModel::Fisheye}) {
        Camera camera = through({}, lens, {-0.25, 0.05, 0.01, 0});
        camera.world_from_camera = look_at({0.1f, 0.9f, 0.2f}, {0, 0, 0}, {0, 0, -1});
        RenderSettings settings;
        settings.width = settings.height = 24, settings.samples = 256;
        settings.path.max_depth = 1;
        const double by_paths = test::mean_of(test::render(queue, scene, camera, settings).picture);
        settings.integrator = IntegratorKind::Light;
        const double by_light = test::mean_of(test::render(queue, scene, camera, settings).picture);
        CHECK(by_light == doctest::Approx(by_paths).epsilon(0.01));
        CHECK(by_paths > 0.01);
    }
}

TEST_CASE(
    "what is small and out of focus shows the blades, upright behind the plane in focus and upside down before it") {
    constexpr uint32_t kSide = 12;
    constexpr float kHalfView = 0.3f, kHalfSize = 0.15f; // at the distances 1 and 2
    Queue queue = test::requested_queue();
    for (const float distance : {2.0f, 0.5f}) {
        CAPTURE(distance);
        const float half_size = kHalfSize * 0.5f * distance;
        Scene scene;
        test::add(scene, test::sheet({0, 0, -distance}, {half_size, 0, 0}, {0, half_size, 0}), test::white(0.5f));
        scene.lights.push_back({.kind = LightKind::Directional, .direction = {0, 0, -1}, .intensity = grey(2 * kPi)});
        Camera camera;
        camera.fov_y = 2 * std::atan(kHalfView);
        camera.aperture_radius = distance > 1 ? 0.4f : 0.2f;
        camera.aperture = {.blades = 3, .rotation_deg = 75, .ratio = 1.5f};
        const Image expected = expected_bokeh(camera, distance, half_size, kHalfView, kSide);
        RenderSettings settings;
        settings.width = settings.height = kSide, settings.samples = 800;
        settings.filter = PixelFilter::Box;
        settings.path.max_depth = 1;
        for (const IntegratorKind kind : {IntegratorKind::Path, IntegratorKind::Distributed, IntegratorKind::Light,
                                          IntegratorKind::Bidirectional}) {
            CAPTURE(static_cast<int>(kind));
            settings.integrator = kind;
            const Image picture = test::render(queue, scene, camera, settings).picture;
            double difference = 0;
            for (uint32_t y = 0; y < kSide; ++y) {
                for (uint32_t x = 0; x < kSide; ++x)
                    difference += std::abs(double(picture.at(x, y)[0]) - double(expected.at(x, y)[0]));
            }
            CHECK(difference < 0.06 * kSide * kSide * test::mean_of(expected));
            CHECK(test::mean_of(picture) == doctest::Approx(test::mean_of(expected)).epsilon(0.01));
        }
    }
}

TEST_CASE("rasterisation refuses a distorting lens, and svgf only a fisheye") {
    const Scene scene = test::make_furnace_scene(0.5f);
    Queue queue = Queue::make_cpu();
    RenderSettings settings = small_settings();
    settings.integrator = IntegratorKind::Hybrid;
    auto error = test::thrown_error([&] { test::render(queue, scene, lenses()[0], settings); });
    CHECK(test::is_about(error, ErrorCode::BadInput, "integrator", "hybrid"));
    settings.integrator = IntegratorKind::Path;
    settings.denoise = Denoise::Svgf;
    settings.aovs = 0;
    settings.transparent = false;
    error = test::thrown_error([&] { test::render(queue, scene, lenses()[2], settings); });
    CHECK(test::is_about(error, ErrorCode::BadInput, "lens", "fisheye"));
    const Hash128 cpu = test::render_hash(test::render(queue, scene, lenses()[0], settings));
    Queue device = test::requested_queue();
    CHECK(test::render_hash(test::render(device, scene, lenses()[0], settings)) == cpu);
}

TEST_CASE("hybrid rasterises the path tracer's picture for any principal point and focal lengths") {
    const Scene scene = test::make_mixed_scene();
    Queue queue = test::requested_queue();
    Camera camera = test::mixed_scene_camera();
    camera.intrinsics = Intrinsics{30, 24, 5.5, 16.25, 37, 21};
    RenderSettings settings = small_settings();
    const Hash128 paths = test::render_hash(test::render(queue, scene, camera, settings));
    settings.integrator = IntegratorKind::Hybrid;
    CHECK(test::render_hash(test::render(queue, scene, camera, settings)) == paths);
}
