// Pictures through distorting lenses are the same by every schedule and device, show features where OpenCV projects
// them, and are black outside the lens's image. With --device cuda a GPU renders, too.

#include <cmath>

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

/// Lenses over the mixed scene: OpenCV's model with and without a black rim and with an aperture, and a fisheye whose
/// corners are black.
std::vector<Camera> lenses() {
    const Camera plain = test::mixed_scene_camera();
    std::vector<Camera> all = {through(plain, LensModel::OpenCv, {-0.2, 0.05, 0.01, -0.02}),
                               through(plain, LensModel::OpenCv, {-0.9, 0, 0, 0}),
                               through(plain, LensModel::Fisheye, {0.1, -0.05, 0.02, -0.004})};
    all.push_back(all[0]);
    all.back().aperture_radius = 0.1f;
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
        const Image picture = test::render(queue, scene, camera, settings).picture;
        for (int i = 0; i < 6; ++i) {
            CAPTURE(i);
            const double x = 0.5 * double(calibration.seen[i].x), y = 0.5 * double(calibration.seen[i].y);
            double sum = 0, sum_x = 0, sum_y = 0;
            for (uint32_t row = uint32_t(y) - 8; row < uint32_t(y) + 8; ++row) {
                for (uint32_t column = uint32_t(x) - 8; column < uint32_t(x) + 8; ++column) {
                    const double light = double(picture.at(column, row)[0]);
                    sum += light, sum_x += light * (column + 0.5), sum_y += light * (row + 0.5);
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
