// Photon mapping against path tracing: blur and noise fall with the passes at least as fast as published and below a
// bound, and light counts once.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/parallel_for.h"
#include "image/metrics.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "session/opening/open_scene.h"
#include "tests/support/cpu_seconds.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/radiosity_scenes.h"
#include "tests/support/render_scenes.h"
#include "tests/support/room_with_ball.h"
#include "tests/support/solid_scenes.h"

using namespace pertev;

namespace {

struct PhotonCase {
    std::string name;
    Scene scene;
    double bound = 4e-3;              // bound of the squared error after four times 64 passes
    uint32_t reference_samples = 512; // samples per pixel in each of two references
};

std::vector<PhotonCase> photon_cases() {
    const Material wall = test::white(0.6f);
    const Material plastic = test::of_roughness(MaterialKind::MetallicRoughness, 0.4f);
    const Material varnished = test::of_roughness(MaterialKind::MetallicRoughness, 0); // a delta lobe on a diffuse one
    Material leaf = test::of_roughness(MaterialKind::MetallicRoughness, 1);
    leaf.diffuse_transmission_weight = 0.7f; // photons on the back give most of its light
    return {
        {"diffuse", test::room_with_ball(test::white(0.8f), wall, false)},
        {"glass", test::room_with_ball(test::of_roughness(MaterialKind::Dielectric, 0), wall, false)},
        {"leaf", test::room_with_ball(leaf, wall, false), 6e-3},
        {"glossy", test::room_with_ball(test::of_roughness(MaterialKind::MetallicRoughness, 0.3f, 1), plastic, false)},
        {"mirrors under the sky", test::room_with_ball(test::of_roughness(MaterialKind::Conductor, 0), varnished, true),
         4e-2, 2048}}; // because its sun is small
}

/// Returns the mean relative squared error, as the product of the differences from two references, so that the
/// references' noise cancels.
double squared_error(const Image& picture, const Image& one, const Image& other) {
    double sum = 0;
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const auto x = static_cast<double>(picture.pixels[i]), a = static_cast<double>(one.pixels[i]),
                   b = static_cast<double>(other.pixels[i]);
        sum += (x - a) * (x - b) / (a * b + 0.01);
    }
    return sum / static_cast<double>(picture.pixels.size());
}

Image picture_by(Queue& queue, const PreparedScene& prepared, IntegratorKind integrator, PhotonGather gather,
                 uint32_t samples, uint32_t seed) {
    RenderSettings settings;
    settings.width = settings.height = 16;
    settings.filter = PixelFilter::Box;
    settings.path.max_depth = 6;
    settings.path.seed = seed;
    settings.samples = samples;
    settings.integrator = integrator;
    settings.photon_map.edit().photons = 2000;
    settings.photon_map.edit().gather = gather;
    return render_picture(queue, prepared, test::room_camera(), settings).picture;
}

} // namespace

TEST_CASE("photon mapping converges to path tracing at least at Knaus and Zwicker's rate") {
    Queue queue = test::requested_queue();
    for (const PhotonCase& c : photon_cases()) {
        Messages messages;
        const PreparedScene prepared = prepare_scene(c.scene, {}, messages);
        const Image one = picture_by(queue, prepared, IntegratorKind::Path, {}, c.reference_samples, 9);
        const Image other = picture_by(queue, prepared, IntegratorKind::Path, {}, c.reference_samples, 10);
        const double light = (test::mean_of(one) + test::mean_of(other)) / 2;
        for (const PhotonGather gather : {PhotonGather::Direct, PhotonGather::Final}) {
            const auto error_of = [&](uint32_t passes, Image& mean) {
                double sum = 0;
                for (uint32_t seed = 0; seed < 4; ++seed) {
                    const Image picture = picture_by(queue, prepared, IntegratorKind::PhotonMap, gather, passes, seed);
                    sum += squared_error(picture, one, other);
                    if (seed == 0) mean = picture, std::ranges::fill(mean.pixels, 0.0f);
                    for (std::size_t i = 0; i < picture.pixels.size(); ++i) mean.pixels[i] += picture.pixels[i] / 4;
                }
                return sum / 4;
            };
            Image mean;
            const double few = error_of(4, mean), many = error_of(64, mean);
            const double end = squared_error(mean, one, other), means = test::mean_of(mean);
            CAPTURE(c.name);
            CAPTURE(static_cast<int>(gather));
            CAPTURE(few);
            CAPTURE(many);
            CAPTURE(end);
            // The squared error falls with the passes to the power -2/3, unless it is already small.
            CHECK(many < std::max(few * std::pow(16, -2.0 / 3), 3 * c.bound));
            CHECK(end < c.bound);
            CHECK(means == doctest::Approx(light).epsilon(0.01));
        }
    }
}

TEST_CASE("photon mapping has at most a 60th of path tracing's error on a caustic at equal time") {
    Messages messages;
    const Scene scene = open_scene("caustic", messages);
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Camera camera; // the camera sees the floor under the ball, not the emitter's reflection in it
    camera.world_from_camera = look_at({0, 0.6f, 2}, {-0.25f, 0, -0.1f}, {0, 1, 0});
    camera.fov_y = 0.14f;
    Queue all_threads = Queue::make_cpu();
    Queue one_thread = Queue::make_cpu(Threads(1)); // threads that wait for each other use CPU time, too
    Queue* queue = &all_threads;
    const auto render = [&](IntegratorKind integrator, uint32_t samples, uint32_t seed) {
        RenderSettings settings;
        settings.width = settings.height = 32;
        settings.path.max_depth = 8;
        settings.path.seed = seed;
        settings.samples = samples;
        settings.integrator = integrator;
        settings.photon_map.edit().photons = 1u << 12;
        return render_picture(*queue, prepared, camera, settings).picture;
    };
    const Image one = render(IntegratorKind::Bidirectional, 256, 101);
    const Image other = render(IntegratorKind::Bidirectional, 256, 102);
    const auto cost = [&](IntegratorKind integrator, uint32_t samples) {
        const double start = test::cpu_seconds();
        double error = 0;
        for (uint32_t seed = 0; seed < 4; ++seed)
            error += squared_error(render(integrator, samples, seed), one, other) / 4;
        return error * (test::cpu_seconds() - start);
    };
    queue = &one_thread;
    const double path = cost(IntegratorKind::Path, 64), photons = cost(IntegratorKind::PhotonMap, 32);
    CAPTURE(path);
    CAPTURE(photons);
    CHECK(path > 60 * photons);
}

TEST_CASE("an emitter on the floor has at most path tracing's noise from millimetres on") {
    const Material floors[] = {test::white(0.7f), test::of_roughness(MaterialKind::MetallicRoughness, 0.4f)};
    for (const Material& floor : floors) {
        CAPTURE(floor.name);
        Scene scene;
        test::add(scene, test::sheet({0, 0, 0}, {0, 0, 1}, {1, 0, 0}), floor);
        test::add(scene, test::sheet({0, 0.1f, 0}, {0.3f, 0, 0}, {0, 0.1f, 0}), // the emitter faces +z
                  {{.base_color = grey(0), .emission = {20, 20, 20}}, "lamp"});
        Messages messages;
        const PreparedScene prepared = prepare_scene(scene, {}, messages);
        Queue queue = test::requested_queue();
        RenderSettings settings;
        settings.width = settings.height = 8;
        settings.filter = PixelFilter::Box;
        settings.samples = 16;
        settings.path.max_depth = 1; // only light of the emitter, without photons
        settings.photon_map.edit().gather = PhotonGather::Direct;
        const Camera camera = test::camera_down({0, 0.05f, 0.006f}, 0.2f); // floor 1 to 11 mm in front of the wall
        const auto render = [&](IntegratorKind integrator, VarianceOfPictures& variance) {
            settings.integrator = integrator;
            double mean = 0;
            for (settings.path.seed = 0; settings.path.seed < 64; ++settings.path.seed) {
                const Image picture = render_picture(queue, prepared, camera, settings).picture;
                mean += test::mean_of(picture) / 64;
                variance.add(picture);
            }
            return mean;
        };
        VarianceOfPictures of_path, of_photons;
        const double by_path = render(IntegratorKind::Path, of_path),
                     by_photons = render(IntegratorKind::PhotonMap, of_photons);
        const double path = of_path.over(of_path.best_pixels(1)).rel_mse;
        const double photons = of_photons.over(of_photons.best_pixels(1)).rel_mse;
        CAPTURE(path);
        CAPTURE(photons);
        CHECK(photons < 1.5 * path);
        CHECK(by_photons == doctest::Approx(by_path).epsilon(0.01));
    }
}

TEST_CASE("fog shows the light that glass focuses from a point light, as by bidirectional path tracing") {
    Scene scene;
    Material fog;
    fog.make_clear_boundary();
    fog.medium = {.sigma_a = {0.1f, 0, 0}, .sigma_s = {0.2f, 0.4f, 0.8f}, .g = 0.3f};
    test::add(scene, test::box({0, 0, 0}, {1, 1, 1}), fog);
    test::add(scene, test::ball({0, 0.3f, 0}, 0.4f), test::glass(1.5f));
    scene.lights = {test::point_light({0.1f, 0.9f, 0}, {1, 1, 1})};
    Camera camera;
    camera.projection = Projection::Orthographic;
    camera.ortho_height = 0.4f;
    camera.world_from_camera = look_at({0, -0.35f, 3}, {0, -0.35f, 0}, {0, 1, 0}); // below the ball
    Queue queue = test::requested_queue();
    const auto mean_by = [&](IntegratorKind integrator, uint32_t samples) {
        RenderSettings settings;
        settings.width = settings.height = 8;
        settings.samples = samples;
        settings.path.max_depth = 5;
        settings.integrator = integrator;
        settings.photon_map = {.photons = 2000, .radius = 0.1f};
        return test::mean_of(test::render(queue, scene, camera, settings).picture);
    };
    const double by_both = mean_by(IntegratorKind::Bidirectional, 256);
    CHECK(mean_by(IntegratorKind::PhotonMap, 128) == doctest::Approx(by_both).epsilon(0.15).scale(0));
    CHECK(mean_by(IntegratorKind::Path, 64) < 0.8 * by_both);
}

TEST_CASE("a floor has the light that fog scatters onto it once, by photons alone") {
    const Material floors[] = {test::white(0.7f), test::of_roughness(MaterialKind::MetallicRoughness, 0.4f)};
    Queue queue = test::requested_queue();
    for (const Material& floor : floors) {
        CAPTURE(floor.name);
        Scene scene;
        scene.medium = {.sigma_a = {0.5f, 0.5f, 0.5f}, .sigma_s = {2, 2, 2}};
        test::add(scene, test::floor_at(0, 2), floor);
        test::add(scene, test::sheet({0, 0.7f, 0}, {0.3f, 0, 0}, {0, 0, 0.3f}), // the emitter faces down
                  {{.base_color = grey(0), .emission = {20, 20, 20}}, "emitter"});
        const auto mean_by = [&](IntegratorKind integrator, uint32_t samples) {
            RenderSettings settings;
            settings.width = settings.height = 8;
            settings.samples = samples;
            settings.path.max_depth = 5;
            settings.integrator = integrator;
            settings.photon_map = {.photons = 2000, .radius = 0.1f, .gather = PhotonGather::Direct};
            return test::mean_of(
                test::render(queue, scene, test::camera_down({0.5f, 0.1f, 0}, 0.2f), settings).picture);
        };
        CHECK(mean_by(IntegratorKind::PhotonMap, 64) ==
              doctest::Approx(mean_by(IntegratorKind::Path, 512)).epsilon(0.03).scale(0));
    }
}

TEST_CASE("tiny radii and coincident photons do not divide by zero") {
    Queue queue = Queue::make_cpu();
    Scene scene = test::closed_box(test::white(0.5f)); // the view shows surfaces with photons
    scene.lights.push_back(test::point_light({0, 0.5f, 0}, {1, 1, 1}));
    RenderSettings settings;
    settings.integrator = IntegratorKind::PhotonMap;
    settings.width = settings.height = 16;
    settings.samples = 2;
    settings.photon_map.edit().photons = 256;
    settings.photon_map.edit().gather = PhotonGather::Direct;
    for (const float radius : {1e-30f, 3e-20f, kMinPhotonRadius, 1e30f}) {
        for (const uint32_t nearest : {0u, 2u}) {
            settings.photon_map.edit().radius = settings.photon_map.edit().caustic_radius = radius;
            settings.photon_map.edit().nearest = nearest;
            CAPTURE(radius);
            CHECK(test::render(queue, scene, test::camera_down({0, 0, 0}, 0.2f), settings).invalid_samples == 0);
        }
    }
}
