// Participating media (device_scene/media_along_ray.h, integrators/path/homogeneous_medium.h) against closed forms, and
// the same bytes by each schedule.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "device_scene/scene_on_device.h"
#include "image/picture_hash.h"
#include "integrators/path/medium.h"
#include "integrators/photon_map/photon_map_settings.h"
#include "render/light_paths/light_path_layers.h"
#include "session/check_integrator.h"
#include "session/measure_irradiance.h"
#include "session/opening/set_medium.h"
#include "settings/value_names.h"
#include "shading/phase_function.h"
#include "tests/support/estimate.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/solid_scenes.h"

using namespace pertev;

namespace {

constexpr MediumParameters kAmber = {.sigma_a = {0.3f, 0.9f, 2}};
constexpr MediumParameters kMilk = {.sigma_s = {4, 1.5f, 0.5f}, .g = 0.4f};

Material filled(Material material, const MediumParameters& medium) {
    material.medium = medium;
    return material;
}
/// Returns the material of a boundary that only ends its medium.
Material clear_boundary(const MediumParameters& medium) {
    Material material = filled({{}, "boundary"}, medium);
    material.make_clear_boundary();
    return material;
}

/// Returns an orthographic camera, `height` metres high, that looks at the origin from 5 m along `from`.
Camera parallel_view(Vec3 from, float height) {
    Camera camera;
    camera.projection = Projection::Orthographic;
    camera.ortho_height = height;
    camera.world_from_camera = look_at(5 * from, {0, 0, 0}, from.y == 0 ? Vec3{0, 1, 0} : Vec3{0, 0, 1});
    return camera;
}

RenderSettings settings_in_media(uint32_t size, uint32_t samples, uint32_t max_depth) {
    RenderSettings settings = test::square_settings(size, samples, max_depth);
    settings.path.light_choice = LightSelection::Power;
    settings.photon_map = {.photons = 400, .radius = 0.1f};
    return settings;
}

double channel_of(Rgb color, std::size_t channel) {
    return static_cast<double>(channel == 0 ? color.r : channel == 1 ? color.g : color.b);
}

constexpr std::array kOfMedia = {IntegratorKind::Path, IntegratorKind::Light, IntegratorKind::Bidirectional,
                                 IntegratorKind::PhotonMap};

/// Checks that every pixel is the transmittance of `distance` metres of amber. What light tracing cannot see, it skips.
void check_amber(const Scene& scene, const Camera& camera, double distance, bool is_in_glass = false) {
    Queue queue = test::requested_queue();
    for (const IntegratorKind kind : kOfMedia) {
        if (is_in_glass && kind == IntegratorKind::Light) continue;
        CAPTURE(name_of(kind));
        for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
            RenderSettings settings = settings_in_media(3, 2, 8);
            settings.integrator = kind;
            settings.body = body;
            const Image picture = test::render(queue, scene, camera, settings).picture;
            for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
                const double expected = std::exp(-distance * channel_of(kAmber.sigma_a, i % 3));
                CHECK(static_cast<double>(picture.pixels[i]) == doctest::Approx(expected).epsilon(1e-4));
            }
        }
    }
}

test::Estimate channel_mean(const Image& picture, std::size_t channel) {
    const std::size_t count = picture.pixels.size() / 3;
    std::size_t i = 0;
    test::Estimate all = test::estimate(count, [&] { return static_cast<double>(picture.pixels[3 * i++ + channel]); });
    all.error = std::sqrt(all.variance / static_cast<double>(count - 1));
    return all;
}

/// Returns a floor at y = -1 that glows with a radiance of 1, and amber around it.
Scene glowing_floor_in_amber() {
    Scene scene;
    Material glowing;
    glowing.emission = {1, 1, 1};
    test::add(scene, test::sheet({0, -1, 0}, {0, 0, 4}, {4, 0, 0}), glowing);
    scene.medium = kAmber;
    return scene;
}

} // namespace

TEST_CASE("the phase function is a density with its mean cosine, and sampling follows it") {
    for (const float g : {0.0f, 0.3f, -0.6f, 0.95f}) {
        CAPTURE(g);
        double whole = 0, mean = 0;
        constexpr int kSteps = 200'000;
        for (int i = 0; i < kSteps; ++i) {
            const float cosine = -1 + 2 * (static_cast<float>(i) + 0.5f) / kSteps;
            const double density = 4 * 3.14159265358979 / kSteps * static_cast<double>(henyey_greenstein(g, cosine));
            whole += density, mean += density * static_cast<double>(cosine);
        }
        CHECK(whole == doctest::Approx(1).epsilon(1e-3));
        CHECK(mean == doctest::Approx(static_cast<double>(g)).epsilon(2e-3));
        const Vec3 along = normalize(Vec3{0.3f, -0.8f, 0.5f});
        double sampled = 0, squares = 0;
        constexpr uint32_t kDraws = 20'000;
        for (uint32_t i = 0; i < kDraws; ++i) {
            const Hash4 h = hash_words(i, 7, 11, 13);
            const Vec3 wi = sample_henyey_greenstein(g, along, {unit_interval(h.x), unit_interval(h.y)});
            const double cosine = static_cast<double>(dot(wi, along));
            sampled += cosine, squares += cosine * cosine;
        }
        sampled /= kDraws;
        const double error = std::sqrt((squares / kDraws - sampled * sampled) / kDraws);
        CHECK(std::abs(sampled - static_cast<double>(g)) < 4 * error + 1e-6);
    }
}

TEST_CASE("a slab absorbs each colour by its thickness, between clear boundaries and between glass") {
    for (const Material& material : {clear_boundary(kAmber), filled(test::glass(1), kAmber)}) {
        Scene scene = test::under_sky();
        test::add(scene, test::box({0, 0, 0}, {2, 0.35f, 2}), material);
        check_amber(scene, parallel_view({0, 1, 0}, 1), 0.7, !material.is_clear_boundary);
    }
}

TEST_CASE("a medium around everything leaves out the bodies in it, and one with an open surface begins there") {
    Scene scene = glowing_floor_in_amber();
    check_amber(scene, parallel_view({0, 1, 0}, 1), 6);
    Scene hollow = scene;
    test::add(hollow, test::box({0, 1, 0}, {2, 0.5f, 2}), clear_boundary({}));
    check_amber(hollow, parallel_view({0, 1, 0}, 1), 5);
    hollow.instances.back().material = static_cast<uint32_t>(hollow.materials.size());
    hollow.materials.push_back(test::glass(1));
    check_amber(hollow, parallel_view({0, 1, 0}, 1), 5, true);
    scene.medium = {};
    test::add(scene, test::sheet({0, 0.5f, 0}, {0, 0, 4}, {4, 0, 0}), clear_boundary(kAmber));
    check_amber(scene, parallel_view({0, 1, 0}, 1), 1.5);
}

TEST_CASE("a ball that only scatters shows the radiance of the furnace around it") {
    Queue queue = test::requested_queue();
    for (const bool is_clear : {true, false}) {
        CAPTURE(is_clear);
        Scene scene = test::under_sky();
        test::add(scene, test::ball({0, 0, 0}, 1), is_clear ? clear_boundary(kMilk) : filled(test::glass(1.4f), kMilk));
        const auto check_furnace = [&](const RenderSettings& settings, double most_error) {
            const Image picture = test::render(queue, scene, parallel_view({0, 0, 1}, 1), settings).picture;
            for (std::size_t channel = 0; channel < 3; ++channel) {
                CAPTURE(channel);
                const test::Estimate mean = channel_mean(picture, channel);
                CHECK(std::abs(mean.mean - 1) < 4 * mean.error + 1e-4);
                CHECK(mean.error < most_error);
            }
        };
        for (const LightStrategy strategy : {LightStrategy::Mis, LightStrategy::BsdfOnly}) {
            RenderSettings settings = settings_in_media(16, 64, 400);
            settings.path.strategy = strategy;
            check_furnace(settings, 0.01);
        }
        RenderSettings settings = settings_in_media(12, 16, 100);
        settings.integrator = IntegratorKind::Bidirectional; // few particles hit the ball
        check_furnace(settings, 0.06);
    }
}

TEST_CASE("light scattered once in a slab is the integral along the camera's ray") {
    constexpr MediumParameters kHaze = {.sigma_a = {0.5f, 1, 0.1f}, .sigma_s = {3, 1, 0.4f}, .g = -0.3f};
    Queue queue = test::requested_queue();
    Scene scene;
    test::add(scene, test::box({0, 0, 0}, {2, 0.25f, 2}), clear_boundary(kHaze));
    Light sun;
    sun.kind = LightKind::Directional;
    sun.direction = {0, -1, 0};
    sun.intensity = {1, 1, 1};
    scene.lights = {sun};
    for (const IntegratorKind kind : kOfMedia) {
        CAPTURE(name_of(kind));
        RenderSettings settings = settings_in_media(kind == IntegratorKind::Path ? 24 : 16, 256, 1);
        settings.integrator = kind;
        const Image picture = test::render(queue, scene, parallel_view({0, 1, 0}, 1), settings).picture;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            CAPTURE(channel);
            const double sigma = channel_of(kHaze.sigma_t(), channel);
            const double phase = static_cast<double>(henyey_greenstein(kHaze.g, -1));
            const double expected =
                channel_of(kHaze.sigma_s, channel) * phase * -std::expm1(-2 * sigma * 0.5) / (2 * sigma);
            const test::Estimate mean = channel_mean(picture, channel);
            CHECK(std::abs(mean.mean - expected) < 4 * mean.error);
            CHECK(mean.error < (kind == IntegratorKind::Path ? 0.01 : 0.03) * expected);
        }
    }
}

TEST_CASE("each schedule renders the same bytes of glass with a medium, in a clear body, in a medium") {
    Scene scene = test::under_sky();
    scene.medium = {.sigma_a = {0, 0.01f, 0}, .sigma_s = {0.05f, 0.02f, 0}};
    test::add(scene, test::ball({0.3f, 0, 0}, 0.7f), filled(test::glass(1.5f), kMilk));
    test::add(scene, test::box({0, 0.1f, 0}, {1.5f, 0.5f, 1.5f}), clear_boundary({.sigma_s = {0.5f, 1, 2}}));
    Material glowing;
    glowing.emission = {3, 2, 1};
    test::add(scene, test::sheet({0, 3, 0}, {1, 0, 0}, {0, 0, 1}), glowing);
    Queue cpu = Queue::make_cpu(), queue = test::requested_queue();
    RenderSettings settings = settings_in_media(12, 4, 20);
    settings.path.roulette_depth = 3;
    settings.aovs = kAovAlbedo | kAovDepth;
    const Hash128 loop = test::render_hash(test::render(cpu, scene, parallel_view({0, 0, 1}, 3), settings));
    settings.body = PathBody::Wavefront;
    CHECK(test::render_hash(test::render(queue, scene, parallel_view({0, 0, 1}, 3), settings)) == loop);
    settings.path.light_choice = LightSelection::Tree;
    for (const IntegratorKind kind : kOfMedia) {
        CAPTURE(name_of(kind));
        settings.integrator = kind;
        settings.body = PathBody::Loop;
        const Hash128 of_two = test::render_hash(test::render(cpu, scene, parallel_view({0, 0, 1}, 3), settings));
        Queue one = Queue::make_cpu(Threads(1));
        CHECK(test::render_hash(test::render(one, scene, parallel_view({0, 0, 1}, 3), settings)) == of_two);
        settings.body = PathBody::Wavefront;
        CHECK(test::render_hash(test::render(queue, scene, parallel_view({0, 0, 1}, 3), settings)) == of_two);
    }
}

TEST_CASE("in media light tracing, bidirectional path tracing and photon mapping have the means of path tracing") {
    Scene scene; // lights are in haze, in a cloud, in milk and in a hollow, and the camera and the floor in the haze
    scene.medium = {.sigma_s = {0.02f, 0.01f, 0}};
    const MediumParameters haze = {.sigma_a = {0.05f, 0.02f, 0}, .sigma_s = {0.1f, 0.2f, 0.4f}, .g = 0.4f};
    test::add(scene, test::box({0, 0.5f, 0.5f}, {2.5f, 2, 2.7f}), clear_boundary(haze));
    test::add(scene, test::floor_at(-1, 2), test::white(0.6f));
    test::add(scene, test::box({-0.7f, 0, 0}, {0.6f, 0.7f, 0.6f}),
              clear_boundary({.sigma_s = {2, 1, 0.5f}, .g = -0.5f}));
    test::add(scene, test::ball({-0.6f, 0, 0.2f}, 0.3f), clear_boundary({}));
    Material rough = filled(test::glass(1.3f), kMilk);
    rough.roughness = 0.6f;
    test::add(scene, test::ball({0.8f, -0.3f, 0}, 0.6f), rough);
    Material glowing;
    glowing.emission = {2, 3, 4};
    glowing.two_sided_emission = true;
    test::add(scene, test::sheet({-0.7f, 0.5f, 0}, {0.2f, 0, 0}, {0, 0, 0.2f}), glowing);
    test::add(scene, test::sheet({0.8f, -0.3f, 0}, {0.2f, 0, 0}, {0, 0, 0.2f}), glowing);
    test::add(scene, test::sheet({-0.9f, 0.9f, 0}, {0, 0.4f, 0}, {0, 0, 0.3f}), glowing); // half of it in the cloud
    scene.lights = {test::point_light({-0.6f, 0, 0.2f}, {1, 2, 1}), test::point_light({0.6f, 1, 0.5f}, {3, 1, 2})};
    Camera camera;
    camera.world_from_camera = look_at({0, 0.6f, 2.5f}, {0, 0, 0}, {0, 1, 0});
    Queue queue = test::requested_queue();
    constexpr uint32_t kBlock = 4, kSize = 8, kSamples[] = {48, 64, 8, 16}, kBlocks = 3 * 4;
    std::vector<test::Estimate> blocks[kOfMedia.size()];
    for (std::size_t k = 0; k < kOfMedia.size(); ++k) {
        RenderSettings settings = settings_in_media(kSize, kSamples[k], 6);
        settings.integrator = kOfMedia[k];
        std::vector<std::vector<double>> means(kBlocks);
        for (uint32_t run = 0; run < 12; ++run) {
            settings.path.seed = 100 * static_cast<uint32_t>(k) + run;
            const Image picture = test::render(queue, scene, camera, settings).picture;
            std::vector<double> sums(kBlocks);
            for (uint32_t i = 0; i < 3 * kSize * kSize; ++i) {
                const uint32_t x = i / 3 % kSize / kBlock, y = i / 3 / kSize / kBlock;
                sums[3 * (y * (kSize / kBlock) + x) + i % 3] += static_cast<double>(picture.pixels[i]);
            }
            for (uint32_t block = 0; block < kBlocks; ++block) means[block].push_back(sums[block]);
        }
        for (const std::vector<double>& of_block : means) {
            std::size_t i = 0;
            blocks[k].push_back(test::estimate(of_block.size(), [&] { return of_block[i++]; }));
        }
    }
    for (std::size_t k = 1; k < kOfMedia.size(); ++k) {
        CAPTURE(name_of(kOfMedia[k]));
        double largest = 0, sum = 0, error = 0, whole = 0;
        for (uint32_t block = 0; block < kBlocks; ++block) {
            const test::Estimate &a = blocks[k][block], &b = blocks[0][block];
            const double of_difference = std::hypot(a.error, b.error);
            largest = std::max(largest, std::abs(a.mean - b.mean) / of_difference);
            sum += a.mean - b.mean, whole += b.mean, error = std::hypot(error, of_difference);
        }
        CHECK(largest < 6); // Student's distribution has wide tails for so few runs
        CHECK(std::abs(sum) < 4 * error);
        CHECK(error < 0.04 * whole);
    }
}

TEST_CASE("media of any size look alike, and a punctual light's range ends in a medium as elsewhere") {
    const auto mean_of = [](IntegratorKind kind, float scale, float range, uint32_t samples) {
        Scene scene;
        test::add(scene, test::ball({0, 0, 0}, scale), clear_boundary({.sigma_s = {8 / scale, 4 / scale, 2 / scale}}));
        scene.lights = {test::point_light({0, 0, 0}, {scale * scale, scale * scale, scale * scale})};
        scene.lights[0].range = range * scale;
        Camera camera;
        camera.world_from_camera = look_at(scale * Vec3{0, 0.2f, 0.55f}, {0, 0, 0}, {0, 1, 0});
        RenderSettings settings = settings_in_media(8, samples, 6);
        settings.integrator = kind;
        Queue queue = test::requested_queue();
        return channel_mean(test::render(queue, scene, camera, settings).picture, 1).mean;
    };
    const double here = mean_of(IntegratorKind::Bidirectional, 1, 0, 16);
    for (const float scale : {0x1p-10f, 0x1p+17f})
        CHECK(mean_of(IntegratorKind::Bidirectional, scale, 0, 16) == doctest::Approx(here).epsilon(0.02));
    const double by_path = mean_of(IntegratorKind::Path, 1, 0.7f, 512);
    for (const IntegratorKind kind : kOfMedia)
        CHECK(mean_of(kind, 1, 0.7f, kind == IntegratorKind::PhotonMap ? 128 : 512) ==
              doctest::Approx(by_path).epsilon(0.1));
}

TEST_CASE("a camera in a body begins in its medium, and a solid without a medium in a scene with one absorbs") {
    Scene scene = test::under_sky();
    test::add(scene, test::box({0, 0, 0}, {1, 1, 1}), clear_boundary(kAmber));
    check_amber(scene, parallel_view({0, 0.1f, 0}, 1), 1.5);
    Material absorbing = test::glass(1);
    absorbing.transmission_depth = 1;
    absorbing.transmission_color = transmittance_of(kAmber.sigma_a);
    Mesh open = test::box({0, 3, 0}, {2, 0.35f, 2});
    open.indices.resize(open.indices.size() - 3);
    test::add(scene, open, absorbing);
    check_amber(scene, parallel_view({0, 1, 0}, 1), 2.7, true);
}

TEST_CASE("a scattering far from the origin is within its body") {
    Scene scene = test::under_sky();
    test::add(scene, test::box({0, 1024, 1024}, {2, 0.5f, 2}), clear_boundary({.sigma_s = {2e4f, 2e4f, 2e4f}}));
    test::add(scene, test::box({0, -1024, -1024}, {1, 1, 1}), test::white()); // the centre stays
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = Queue::make_cpu();
    const SceneOnDevice device(queue, prepared);
    PathJob job = {};
    job.picture.scene = device.view();
    constexpr Hit kNone = {kInfinity, 0, 0, kNoHit, kNoHit};
    double least = 1e9;
    uint32_t scatterings = 0;
    for (uint32_t i = 0; i < 4000; ++i) {
        PathState path = {};
        path.pixel = i;
        path.throughput = {1, 1, 1};
        const float x = 1e-4f * static_cast<float>(i);
        path.origin = Vec3{x, 1025.3f, 1024 + x} - prepared.centre;
        path.direction = normalize(Vec3{0.3f, -0.8f, 0.2f + x});
        MediumVertex vertex;
        if (!HomogeneousMedium<kAnyFilm | kMedia>(job.picture.scene).scatters(job, path, kNone, vertex)) continue;
        ++scatterings;
        least = std::min(least, 1024.5 - static_cast<double>(vertex.position.y + prepared.centre.y));
    }
    CHECK(scatterings > 3900);
    CHECK(least > 0);
}

TEST_CASE("in a medium lights that are sampled, hit, or both have one mean, by power and by the light tree") {
    Scene scene;
    scene.medium = {.sigma_a = {0.05f, 0, 0.1f}, .sigma_s = {0.4f, 0.6f, 0.2f}, .g = 0.3f};
    test::add(scene, test::floor_at(0, 1), test::white());
    Material glowing;
    glowing.emission = {1, 1, 1};
    glowing.two_sided_emission = true;
    for (const float x : {-2.2f, 2.2f}) { // below the floor, which does not see them
        test::add(scene, test::sheet({x, -0.4f, 0}, {0, 0, 2}, {1, 0, 0}), glowing);
    }
    Queue queue = test::requested_queue();
    test::Estimate first[3];
    for (const LightSelection selection : {LightSelection::Power, LightSelection::Tree}) {
        for (const LightStrategy strategy : {LightStrategy::BsdfOnly, LightStrategy::Mis, LightStrategy::NeeOnly}) {
            RenderSettings settings = settings_in_media(16, 256, 3);
            settings.path.strategy = strategy;
            settings.path.light_choice = selection;
            const Image picture = test::render(queue, scene, parallel_view({0, 1, 0}, 1.8f), settings).picture;
            for (std::size_t channel = 0; channel < 3; ++channel) {
                CAPTURE(channel);
                const test::Estimate mean = channel_mean(picture, channel);
                if (selection == LightSelection::Power && strategy == LightStrategy::BsdfOnly) first[channel] = mean;
                CHECK(std::abs(mean.mean - first[channel].mean) < 4 * std::hypot(mean.error, first[channel].error));
                CHECK(mean.error < (strategy == LightStrategy::Mis ? 0.02 : 0.05) * mean.mean);
            }
        }
    }
}

TEST_CASE("integrators without media refuse or warn") {
    Scene scene = test::under_sky();
    scene.medium = kMilk;
    scene.lights = {test::point_light({0, 2, 0}, {8, 8, 8})};
    RenderSettings settings;
    std::string silent;
    for (const std::string& name : integrator_names()) {
        set_integrator(settings, name);
        Messages messages;
        check_light(settings, scene, messages);
        if (messages.left_out().empty()) silent += name + " ";
    }
    CHECK(silent == "path direct indirect hybrid light bidirectional photon_map ");
    settings.integrator = IntegratorKind::Path;
    Messages none;
    check_light(settings, scene, none);
    CHECK(none.all().empty());
    settings.irradiance = true;
    CHECK_THROWS_AS(check_light(settings, scene, none), Error);
}

TEST_CASE("the text of a medium has coefficients for each colour or for all") {
    const MediumParameters read = parse_medium("sigma_s=0.1,0.2,0.3 g=-0.5 sigma_a=2");
    CHECK(read.sigma_s == Rgb{0.1f, 0.2f, 0.3f});
    CHECK(read.sigma_a == Rgb{2, 2, 2});
    CHECK(read.g == -0.5f);
    CHECK(parse_medium("none") == MediumParameters());
    for (const char* wrong : {"sigma_s=-1", "sigma=1", "g=1 sigma_s=1", "sigma_s=a", "g=0.5", ""}) {
        CAPTURE(wrong);
        CHECK_THROWS_AS(parse_medium(wrong), Error);
    }
}

TEST_CASE("a light meter in a medium measures lights that it dims") {
    Scene scene;
    scene.medium = kAmber;
    scene.lights = {test::point_light({0, 2, 0}, {8, 8, 8})};
    test::add(scene, test::floor_at(-1, 1), test::white());
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    RenderSettings settings;
    settings.samples = 1;
    const Irradiance measured = measure_irradiance(queue, prepared, {{0, 0, 0}, {0, 1, 0}}, settings);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const double expected = 2 * std::exp(-2 * channel_of(kAmber.sigma_a, channel));
        CHECK(measured.rgb[channel].value == doctest::Approx(expected).epsilon(1e-4));
    }
}

TEST_CASE("bodies that share a face have each its own medium") {
    Scene scene = test::under_sky();
    test::add(scene, test::box({0, 0.5f, 0}, {2, 0.5f, 2}), clear_boundary(kAmber));
    test::add(scene, test::box({0, -0.25f, 0}, {2, 0.25f, 2}), clear_boundary({}));
    test::add(scene, test::box({0, -0.75f, 0}, {2, 0.25f, 2}), clear_boundary(kAmber));
    check_amber(scene, parallel_view({0, 1, 0}, 1), 1.5);
}

TEST_CASE("layers of light paths take a medium's scattering as diffuse and add up to the picture") {
    Scene scene = test::under_sky();
    scene.medium = {.sigma_s = {0.1f, 0.2f, 0.05f}};
    test::add(scene, test::box({0, 0, 0}, {1, 0.5f, 1}), clear_boundary(kMilk));
    scene.instances.back().name = "milk";
    test::add(scene, test::floor_at(-1, 2), test::white(0.5f));
    scene.lights = {test::point_light({0, 2, 0}, {8, 8, 8})};
    std::vector<LightPathExpression> expressions;
    for (const char* text : {"all=L.*E", "milk=L.*D<'milk'>.*E", "others=L(D<^'milk'>)*E", "glossy=L.*[GS].*E"}) {
        expressions.push_back(parse_light_path(text));
    }
    RenderSettings settings = settings_in_media(8, 8, 6);
    settings.light_paths = std::make_shared<const LightPathLayers>(bind_to_scene(std::move(expressions), scene));
    Queue cpu = Queue::make_cpu(), queue = test::requested_queue();
    const RenderResult result = test::render(cpu, scene, parallel_view({0, 1, 0}, 3), settings);
    settings.body = PathBody::Wavefront;
    CHECK(test::render_hash(test::render(queue, scene, parallel_view({0, 1, 0}, 3), settings)) ==
          test::render_hash(result));
    double in_milk = 0;
    for (std::size_t i = 0; i < result.picture.pixels.size(); ++i) {
        const auto of = [&](const char* name) { return static_cast<double>(layer_named(result, name).pixels[i]); };
        CHECK(of("all") == doctest::Approx(static_cast<double>(result.picture.pixels[i])).epsilon(1e-5));
        CHECK(of("milk") + of("others") == doctest::Approx(of("all")).epsilon(1e-5));
        CHECK(of("glossy") == 0);
        in_milk += of("milk");
    }
    CHECK(in_milk > 0);
}

TEST_CASE("frames of a medium show it, by the same bytes on each schedule") {
    Scene scene = glowing_floor_in_amber();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Hash128 hashes[2];
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        Queue queue = test::requested_queue();
        RenderSettings settings = settings_in_media(8, 1, 4);
        settings.body = body;
        Session session(queue, prepared, parallel_view({0, 1, 0}, 1), settings);
        session.render_frame(0, ReconstructionSettings());
        const Image frame = session.frame().picture();
        for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
            const double expected = std::exp(-6 * channel_of(kAmber.sigma_a, i % 3));
            CHECK(static_cast<double>(frame.pixels[i]) == doctest::Approx(expected).epsilon(1e-3));
        }
        hashes[body == PathBody::Wavefront ? 1 : 0] = picture_hash(frame);
    }
    CHECK(hashes[0] == hashes[1]);
}
