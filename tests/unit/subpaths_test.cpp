// The parts of light tracing against their inverses, and pictures by light and bidirectional against closed forms.

#include <doctest/doctest.h>

#include <string>

#include "integrators/subpaths/particle_stages.h"
#include "render/connect_to_camera.h"
#include "render/filter_table.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

TEST_CASE("the pixel filter's density equals that of camera rays") {
    Queue queue = Queue::make_cpu();
    for (const PixelFilter kind :
         {PixelFilter::Box, PixelFilter::Tent, PixelFilter::Gaussian, PixelFilter::BlackmanHarris}) {
        CAPTURE(static_cast<int>(kind));
        FilterTable table(queue);
        const PixelFilterView filter = table.set(kind, 1.25f);
        constexpr int kSteps = 20000;
        double sum = 0;
        int next = 1;
        for (int i = 0; i < kSteps; ++i) {
            const float x = 1.25f * (2.0f * (static_cast<float>(i) + 0.5f) / kSteps - 1.0f);
            sum += static_cast<double>(filter_density(filter, x)) * 2.5 / kSteps;
            while (next < 50 && sample_filter_axis(filter, static_cast<float>(next) / 50) < x) {
                CHECK(sum == doctest::Approx(next / 50.0).epsilon(1e-3)); // the part below it
                ++next;
            }
        }
        CHECK(next == 50);
        CHECK(sum == doctest::Approx(1).epsilon(1e-3));
        CHECK(filter_density(filter, 1.26f) == 0);
    }
}

TEST_CASE("a vertex projects to the pixel whose camera ray reaches it") {
    test::Random random(7);
    for (const Projection projection : {Projection::Perspective, Projection::Orthographic}) {
        for (const auto& [aperture, is_distorted] :
             {std::pair(0.0f, false), {0.3f, false}, {0.0f, true}, {0.3f, true}}) {
            Camera camera;
            camera.projection = projection;
            camera.world_from_camera = look_at({1, 2, 3}, {-0.5f, 0.2f, -1}, {0.1f, 1, 0});
            camera.fov_y = 0.8f;
            camera.aperture_radius = aperture;
            camera.focus_distance = 2.5f;
            if (is_distorted) camera.lens = LensModel::OpenCv, camera.distortion = {-0.2, 0.05, 0.01, -0.02};
            const CameraRays rays = make_camera_rays(camera, {PixelFilter::Box, 0.5f, nullptr}, 40, 30, {0, 0, 0});
            for (int i = 0; i < 100; ++i) {
                const float x = 40 * random.unit(), y = 30 * random.unit(), distance = 1 + 4 * random.unit();
                const float u = random.unit();
                const Vec2 lens = {u, random.unit()};
                const Ray ray = make_camera_ray(rays.view, {x, y}, lens);
                CameraConnection seen;
                REQUIRE(connect_to_camera(rays, ray.origin + distance * ray.direction, lens, seen));
                CHECK(seen.raster.x == doctest::Approx(x).epsilon(1e-4));
                CHECK(seen.raster.y == doctest::Approx(y).epsilon(1e-4));
                CHECK(length(seen.from - ray.origin) < 1e-4f);
                CHECK(length(seen.direction - ray.direction) < 1e-4f);
                CHECK_FALSE(connect_to_camera(rays, ray.origin - distance * ray.direction, lens,
                                              seen)); // lies behind the camera
            }
        }
    }
}

namespace {

/// Returns the mean radiance around the origin, seen straight down from just above the floor.
double seen_below(const Scene& scene, IntegratorKind integrator, uint32_t samples, float camera = 0.1f) {
    RenderSettings settings;
    settings.width = settings.height = 8;
    settings.samples = samples;
    settings.integrator = integrator;
    settings.filter = PixelFilter::Box;
    settings.path.max_depth = 6;
    Queue queue = test::requested_queue();
    const RenderResult result = test::render(queue, scene, test::camera_down({0, camera, 0}, 0.2f), settings);
    return test::mean_of(result.picture);
}

constexpr double kFloor = 0.5 * 8 / 3.14159265; // albedo I / pi, at 1 m; 1 % less towards the view's corners

} // namespace

TEST_CASE("a floor under a spot light has the radiance of the closed form") {
    CHECK(seen_below(test::floor_under_spot(), IntegratorKind::Path, 4) == doctest::Approx(kFloor).epsilon(0.02));
    CHECK(seen_below(test::floor_under_spot(), IntegratorKind::Light, 4096) == doctest::Approx(kFloor).epsilon(0.02));
    CHECK(seen_below(test::floor_under_spot(), IntegratorKind::Bidirectional, 256) ==
          doctest::Approx(kFloor).epsilon(0.02));
}

TEST_CASE("a point light behind glass lights the floor in all but path tracing") {
    Scene scene = test::floor_under_spot();
    const Material glass = {{.kind = MaterialKind::Dielectric, .base_color = {1, 1, 1}, .ior = 1.5f}, "glass"};
    test::add(scene, test::floor_at(0.6f, 2), glass);
    test::add(scene, test::sheet({0, 0.4f, 0}, {2, 0, 0}, {0, 0, 2}), glass); // faces down
    scene.materials.back().roughness = scene.materials[1].roughness = 0;
    // With all reflections between the two faces, 2 n / (n^2 + 1) of the light passes. The light appears 0.2 (1 - 1 /
    // n) m nearer.
    const double nearer = 1 - 0.2 * (1 - 1 / 1.5), expected = kFloor * 2 * 1.5 / (1.5 * 1.5 + 1) / (nearer * nearer);
    CHECK(seen_below(scene, IntegratorKind::Path, 64) == 0);
    CHECK(seen_below(scene, IntegratorKind::Light, 4096) == doctest::Approx(expected).epsilon(0.03));
    CHECK(seen_below(scene, IntegratorKind::Bidirectional, 4096) == doctest::Approx(expected).epsilon(0.03));
}

TEST_CASE("light tracing misses mirror images, bidirectional path tracing does not") {
    Scene scene;
    test::add(scene, test::floor_at(0, 4), test::mirror());
    test::add(scene, test::sheet({0, 2, 0}, {4, 0, 0}, {0, 0, 4}),
              {{.base_color = {0, 0, 0}, .emission = {3, 3, 3}}, "lamp"});
    const double path = seen_below(scene, IntegratorKind::Path, 16);
    CHECK(path == doctest::Approx(3).epsilon(0.01));
    CHECK(seen_below(scene, IntegratorKind::Light, 16) == 0);
    CHECK(seen_below(scene, IntegratorKind::Bidirectional, 16) == doctest::Approx(path).epsilon(1e-6));
}

TEST_CASE("weights of all techniques of a light path add up to 1, however next-event estimation selects the light") {
    test::Random random(11);
    for (int i = 0; i < 200; ++i) {
        const auto any = [&](float least, float most) { return least + (most - least) * random.unit(); };
        // The path's vertices are a light, two surfaces and the camera. Segments are numbered from the light on,
        // cosines by surface and segment, densities of a surface by the side from which its subpath arrives.
        const float squares[] = {any(0.1f, 9), any(0.1f, 9), any(0.1f, 9)};
        const float cos_light = any(0.1f, 1),
                    cosines[2][2] = {{any(0.1f, 1), any(0.1f, 1)}, {any(0.1f, 1), any(0.1f, 1)}};
        const float of_camera[] = {any(0.1f, 3), any(0.1f, 3)}, of_light[] = {any(0.1f, 3), any(0.1f, 3)};
        const float at_lens = any(1, 9), emission = any(0.1f, 3), position = any(0.01f, 9);
        const float ratio = i % 2 == 0 ? 1 : any(0, 30);

        MisSums light = {square(1 / emission), square(cos_light / (position * emission))};
        light.arrive(cosines[0][0], squares[0]);
        light.select_light(ratio);
        const MisSums light_at_first = light;
        light.scatter(cosines[0][1], of_light[0], of_camera[0]);
        light.arrive(cosines[1][0], squares[1]);
        const float seen = at_lens * cosines[1][1] / squares[2];
        const float by_lens = mis_weight(squared_density(seen) * light.weight_sum(of_camera[1]));

        MisSums camera = {square(1 / at_lens), 0};
        camera.arrive(cosines[1][1], squares[2]);
        const float forward = of_camera[1] * cosines[0][1] / squares[1];
        const float backwards = of_light[0] * cosines[1][0] / squares[1];
        const float by_connection = mis_weight(squared_density(forward) * light_at_first.weight_sum(of_camera[0]) +
                                               squared_density(backwards) * camera.weight_sum(of_light[1]));
        camera.scatter(cosines[1][0], of_camera[1], of_light[1]);
        camera.arrive(cosines[0][1], squares[1]);
        float by_sampled_light = 0;
        if (ratio > 0) {
            const float sampled = ratio * position * squares[0] / cos_light;
            const float arriving = emission / squares[0] * cosines[0][0] / ratio;
            by_sampled_light = mis_weight(squared_density(of_camera[0] / sampled) +
                                          squared_density(arriving) * camera.weight_sum(of_light[0]));
        }
        camera.scatter(cosines[0][0], of_camera[0], of_light[0]);
        camera.arrive(cos_light, squares[0]);
        const LightDensities hit = {position, emission, ratio};
        const float by_hit = mis_weight(hit.weight_sum_by_tree(camera));
        CHECK(by_lens + by_connection + by_sampled_light + by_hit == doctest::Approx(1).epsilon(1e-4));
        if (ratio == 1) CHECK(by_hit == doctest::Approx(mis_weight(hit.weight_sum(camera))).epsilon(1e-5));
    }
}

TEST_CASE("light that perfect interfaces scatter ends by chance after 64 vertices, and its weight makes up for that") {
    constexpr uint32_t kSamples = 20'000;
    const SubpathSettings settings;
    const auto survivors = [&](LobeClass lobe_class, uint32_t vertex, double& weight) {
        uint32_t count = 0;
        for (uint32_t i = 0; i < kSamples; ++i) {
            BsdfSample sample = {.weight = grey(1), .pdf = 1, .lobe_class = lobe_class};
            if (!survives(settings, {i, 0, 0}, 3, vertex, sample)) continue;
            ++count;
            weight += static_cast<double>(sample.weight.g) / kSamples;
        }
        return count;
    };
    double of_short = 0, of_long = 0, of_rough = 0;
    CHECK(survivors(LobeClass::Specular, 64, of_short) == kSamples);
    CHECK(survivors(LobeClass::Diffuse, 1000, of_rough) == kSamples); // little loss in many scatterings is no trap
    const double share = survivors(LobeClass::Specular, 65, of_long) / double(kSamples);
    CHECK(share > 0.975);
    CHECK(share < 0.985);
    CHECK(of_short == doctest::Approx(1));
    CHECK(of_rough == doctest::Approx(1));
    CHECK(of_long == doctest::Approx(1).epsilon(0.005));
}
