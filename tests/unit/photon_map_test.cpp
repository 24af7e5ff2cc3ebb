// The parts of photon mapping, and pictures against closed forms.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "device/launch.h"
#include "device_scene/scene_on_device.h"
#include "integrators/photon_map/order_photons.h"
#include "integrators/photon_map/photon_map_integrator.h"
#include "integrators/photon_map/photon_targets.h"
#include "render/film.h"
#include "render/filter_table.h"
#include "session/check_integrator.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/room_with_ball.h"
#include "tests/support/stress_points.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

TEST_CASE("the radius of a pass is Knaus and Zwicker's and depends only on the pass") {
    CHECK(radius_of_pass(0) == 1);
    const double a = 2.0 / 3;
    double squared = 1;
    for (uint32_t pass = 1; pass < 200; ++pass) {
        squared *= (pass + a) / (pass + 1);
        CHECK(static_cast<double>(radius_of_pass(pass)) == doctest::Approx(std::sqrt(squared)).epsilon(1e-6));
    }
    // The product is Gamma(k + 1 + a) / (Gamma(1 + a) Gamma(k + 2)).
    const double k = 100'000, logarithm = std::lgamma(k + 1 + a) - std::lgamma(1 + a) - std::lgamma(k + 2);
    CHECK(static_cast<double>(radius_of_pass(100'000)) == doctest::Approx(std::exp(0.5 * logarithm)).epsilon(1e-5));
}

TEST_CASE("photons are aimed with the reported density, wherever the target spheres lie") {
    const Float4 near_each_other[] = {{1, 0, 0, 0.4f}, {1.3f, 0.3f, 0, 0.4f}, {-2, 1, 0.5f, 0.1f}};
    const Float4 round_all[] = {{0.1f, 0, 0, 1}, {3, 0, 0, 0.5f}};
    for (const PhotonTargetsView targets : {PhotonTargetsView{near_each_other, 3}, PhotonTargetsView{round_all, 2}}) {
        constexpr int kDraws = 100'000;
        const auto is_in_a_cone = [&](Vec3 direction) {
            for (uint32_t i = 0; i < targets.count; ++i) {
                const Vec3 axis = aim::axis_to({0, 0, 0}, targets.spheres[i]);
                if (1 - dot(axis, direction) < aim::depth_of_cone({0, 0, 0}, targets.spheres[i])) return true;
            }
            return false;
        };
        test::Random random(5);
        const auto draw = [&] {
            const float x = random.unit();
            return Vec2{x, random.unit()};
        };
        // Estimates the integral of f over the cones from samples inside and from samples everywhere.
        const auto f = [](Vec3 w) { return static_cast<double>(1 + w.x + 0.5f * w.y); };
        double aimed = 0, everywhere = 0;
        for (int i = 0; i < kDraws; ++i) {
            const aim::Direction direction = aim::draw_direction(targets, {0, 0, 0}, draw());
            aimed += f(direction.to) / static_cast<double>(direction.pdf) / kDraws;
            const Vec3 other = sample_uniform_sphere(draw());
            if (is_in_a_cone(other)) everywhere += f(other) / static_cast<double>(pdf_uniform_sphere()) / kDraws;
        }
        CHECK(aimed == doctest::Approx(everywhere).epsilon(0.02));

        // Estimates the area of all discs perpendicular to a direction.
        const Vec3 along = normalize(Vec3{0.3f, -1, 0.2f});
        const WorldSphere world = {{0, 0, 0}, 4};
        const Frame frame = make_frame(along);
        double by_aim = 0, by_chance = 0;
        for (int i = 0; i < kDraws; ++i) {
            const aim::Start start = aim::draw_start(targets, world, along, draw());
            CHECK(std::abs(dot(start.from, along) + 4) < 1e-4f); // the ray starts outside the world
            by_aim += 1 / static_cast<double>(start.pdf) / kDraws;
            const Vec2 u = draw();
            const Vec3 through = frame.to_world({8 * u.x - 4, 8 * u.y - 4, 0});
            const bool meets = std::any_of(targets.spheres, targets.spheres + targets.count, [&](const Float4& s) {
                const Vec3 off = Vec3{s.x, s.y, s.z} - through;
                return length(off - dot(off, along) * along) < s.w;
            });
            if (meets) by_chance += 64.0 / kDraws;
        }
        CHECK(by_aim == doctest::Approx(by_chance).epsilon(0.03));
    }
}

namespace {

/// One pass of photon mapping of a scene, with the energy of its photons.
struct PhotonRun {
    PhotonEnergy energy{};
    PhotonCounts counts{};
    FixedSum stored{}; // the sum of the powers of all photons in the maps, over all three channels
    uint32_t left_out = 0;

    PhotonRun(const Scene& scene, uint32_t max_depth, uint32_t photons, bool in_loop = true,
              PhotonGather gather = PhotonGather::Final, float radius = 0, uint32_t nearest = 0) {
        Messages messages;
        const PreparedScene prepared = prepare_scene(scene, {}, messages);
        Queue queue = Queue::make_cpu();
        const SceneOnDevice device(queue, prepared);
        SceneTracer tracer(queue, *prepared.structures, default_tracers(false));
        tracer.set_surfaces(device.view());
        FilterTable filter(queue);
        const PictureView picture = {device.view(),
                                     make_camera_rays(test::camera_down({0, 0.1f, 0}, 0.2f),
                                                      filter.set(PixelFilter::Box, 0.5f), 8, 8, prepared.centre)};
        PhotonMapIntegrator integrator(
            queue,
            {{.max_depth = max_depth}, {.photons = photons, .radius = radius, .nearest = nearest, .gather = gather}},
            in_loop, 1u << 20);
        integrator.begin(picture, tracer, 1);
        integrator.record_energy_in(&energy);
        Film film(queue, 8, 8, 0);
        integrator.render(3, 1, film.view());
        counts = integrator.photons();
        const PhotonMapsView& maps = integrator.maps();
        CHECK(maps.global_has_all == (gather == PhotonGather::Final));
        CHECK(maps.caustic.count == counts.caustic);
        add(maps.global);
        if (!maps.global_has_all) add(maps.caustic);
    }

private:
    void add(const PhotonMapView& map) {
        for (uint32_t i = 0; i < map.count; ++i) {
            if (map.photons.positions[i].w == 0) {
                ++left_out;
                continue;
            }
            const Float4 power = map.photons.powers[i];
            stored = stored + to_fixed(power.x + power.y + power.z);
        }
    }
};

double joules(const FixedSum& sum) { return static_cast<double>(mean_of(sum, 1)); }

Scene under_two_faces_of_glass() {
    Scene scene = test::floor_under_spot();
    const Material glass = {{.kind = MaterialKind::Dielectric, .base_color = {1, 1, 1}, .ior = 1.5f}, "glass"};
    test::add(scene, test::floor_at(0.6f, 2), glass);
    test::add(scene, test::sheet({0, 0.4f, 0}, {2, 0, 0}, {0, 0, 2}), glass); // faces down
    scene.materials.back().roughness = scene.materials[1].roughness = 0;
    return scene;
}

Scene sphere_that_glows(float albedo) {
    const test::TriangleMesh sphere = test::make_sphere(3, {0, 0, 0}, 2.0f);
    Scene scene;
    Mesh mesh;
    mesh.positions = sphere.positions;
    mesh.indices = sphere.indices;
    test::add(scene, mesh, {{.base_color = grey(albedo), .emission = {1, 1, 1}}, "wall"});
    scene.materials.back().two_sided_emission = true;
    return scene;
}

/// Returns the mean radiance around the origin, seen straight down from just above the floor.
double mean_seen(const Scene& scene, const RenderSettings& from, Vec3 camera = {0, 0.1f, 0},
                 IntegratorKind integrator = IntegratorKind::PhotonMap) {
    RenderSettings settings = from;
    settings.width = settings.height = 8;
    settings.integrator = integrator;
    settings.filter = PixelFilter::Box;
    Queue queue = test::requested_queue();
    const RenderResult result = test::render(queue, scene, test::camera_down(camera, 0.2f), settings);
    CHECK(result.invalid_samples == 0);
    return test::mean_of(result.picture);
}

} // namespace

TEST_CASE("the energy of emitted photons is the sum of what is stored, absorbed and escapes") {
    const Material glass = test::of_roughness(MaterialKind::Dielectric, 0);
    Scene mixed = test::make_mixed_scene();
    for (Material& material : mixed.materials) {
        if (material.alpha_mode == AlphaMode::Blend) material.alpha = 1; // power there is over the chance to meet it
    }
    const Scene scenes[] = {mixed, under_two_faces_of_glass(), sphere_that_glows(0.5f),
                            test::room_with_ball(glass, test::white(0.6f), false)};
    for (const Scene& scene : scenes) {
        const PhotonRun run(scene, 6, 3000);
        const FixedSum emitted = run.energy.emitted, escaped = run.energy.escaped;
        CHECK(joules(emitted) > 0);
        // No energy is lost on the way, to the last bit. What arrives is in the maps, except where no photon is
        // stored.
        CHECK(emitted + run.energy.went_on == run.energy.arrived + escaped);
        if (&scene != scenes + 1) { // photons that enter at the open sides of this glass count as outside of it
            CHECK(run.stored + run.energy.left_none == run.energy.arrived);
        }
        CHECK(run.left_out == 0);
        CHECK(run.counts.stored > 100);
        CHECK(joules(run.stored) > 0);
        // The wavefront traces the same photons, and so do other kinds of maps.
        for (const PhotonRun& again :
             {PhotonRun(scene, 6, 3000, false), PhotonRun(scene, 6, 3000, true, PhotonGather::Direct)}) {
            CHECK(again.energy.emitted == emitted);
            CHECK(again.energy.escaped == escaped);
            CHECK(again.energy.left_none == run.energy.left_none);
            CHECK(again.stored == run.stored);
            CHECK(again.counts.stored == run.counts.stored);
            CHECK(again.counts.caustic == run.counts.caustic);
        }
    }
}

TEST_CASE("photons in dense cells are dropped and their power goes to the others, but not if estimates use the nearest "
          "photons") {
    const Scene scene = test::room_with_ball(test::white(0.6f), test::white(0.6f), false);
    const PhotonRun all(scene, 6, 12000), some(scene, 6, 12000, true, PhotonGather::Direct, 2),
        nearest(scene, 6, 12000, true, PhotonGather::Direct, 2, 20);
    CHECK(all.left_out == 0);
    CHECK(some.left_out > 1000);
    CHECK(some.left_out < some.counts.stored);
    CHECK(joules(some.stored) == doctest::Approx(joules(all.stored)).epsilon(0.03));
    CHECK(nearest.left_out == 0);
    CHECK(nearest.stored == all.stored);
}

TEST_CASE("photons carry the emitted power, and a closed room keeps the expected part") {
    // Both faces of a sphere of radius 2 emit pi W/m2 in three channels. Photons of the outer face escape.
    const double area = 4 * 3.14159265 * 4 * 0.99,
                 inside = 3 * 3.14159265 * area; // 0.99 because the sphere has flat sides
    const PhotonRun run(sphere_that_glows(0.5f), 5, 20000);
    CHECK(joules(run.energy.emitted) == doctest::Approx(2 * inside).epsilon(0.01));
    CHECK(joules(run.energy.escaped) == doctest::Approx(inside).epsilon(0.01));
    // Arrivals after 1 to 4 scatterings are stored: 1/2 + 1/4 + 1/8 + 1/16 of what is emitted.
    CHECK(joules(run.stored) == doctest::Approx(inside * 15 / 16).epsilon(0.02));
    CHECK(joules(run.energy.arrived) == doctest::Approx(inside * 31 / 16).epsilon(0.02));
    CHECK(run.counts.caustic == 0);
}

TEST_CASE("a floor under an emitter behind glass has the radiance of the closed form from photons alone") {
    RenderSettings settings;
    settings.path.max_depth = 6;
    settings.samples = 8;
    settings.photon_map.edit().photons = 20'000;
    settings.photon_map.edit().caustic_radius = 0.03f;
    constexpr double kFloor = 0.5 * 8 / 3.14159265; // albedo I / pi, at 1 m; 1 % less towards the view's corners
    CHECK(mean_seen(test::floor_under_spot(), settings) ==
          doctest::Approx(kFloor).epsilon(0.02)); // only shadow rays contribute
    // With all reflections between the two faces, 2 n / (n^2 + 1) of the light passes. The light appears 0.2 (1 - 1 /
    // n) m nearer.
    const double nearer = 1 - 0.2 * (1 - 1 / 1.5), behind = kFloor * 2 * 1.5 / (1.5 * 1.5 + 1) / (nearer * nearer);
    const Scene scene = under_two_faces_of_glass();
    CHECK(mean_seen(scene, settings) == doctest::Approx(behind).epsilon(0.03));
    settings.photon_map.edit().nearest = 60;
    CHECK(mean_seen(scene, settings) == doctest::Approx(behind).epsilon(0.03));
    settings.path.max_depth = 2; // besides the floor only one face can scatter
    CHECK(mean_seen(scene, settings) == 0);
}

TEST_CASE("a caustic in a mirror is found, which paths from neither end find") {
    Scene scene = under_two_faces_of_glass();
    test::add(scene, test::sheet({0.5f, 0.2f, 0}, {0, 0, 0.1f}, {0, 0.1f, 0}), test::mirror()); // faces -x
    RenderSettings settings;
    settings.path.max_depth = 8;
    settings.samples = 4;
    settings.photon_map.edit().caustic_radius = 0.03f;
    settings.photon_map.edit().photons = 20'000;
    settings.width = settings.height = 4;
    settings.integrator = IntegratorKind::PhotonMap;
    Camera camera;
    camera.world_from_camera = look_at({0.3f, 0.25f, 0}, {0.5f, 0.15f, 0}, {0, 1, 0});
    camera.fov_y = 0.05f;
    Queue queue = test::requested_queue();
    const double seen = test::mean_of(test::render(queue, scene, camera, settings).picture);
    settings.integrator = IntegratorKind::Bidirectional;
    settings.samples = 64;
    const double by_bidirectional = test::mean_of(test::render(queue, scene, camera, settings).picture);
    CHECK(seen > 0.3);
    CHECK(by_bidirectional < 0.1 * seen);
}

TEST_CASE("a floor within glass is as bright by photon mapping as by path tracing") {
    Scene scene = test::make_furnace_scene(0.6f);
    scene.materials[0] = test::of_roughness(MaterialKind::Dielectric, 0); // the furnace's ball
    test::add(scene, test::floor_at(0, 0.5f), test::white(0.6f));
    for (const PhotonGather gather : {PhotonGather::Direct, PhotonGather::Final}) {
        CAPTURE(static_cast<int>(gather));
        RenderSettings settings;
        settings.path.max_depth = 6;
        settings.samples = 64;
        settings.photon_map = {.photons = 4000, .radius = 0.2f, .caustic_radius = 0.1f, .gather = gather};
        const double by_path = mean_seen(scene, settings, {0, 4, 0}, IntegratorKind::Path);
        CHECK(by_path > 0.2);
        CHECK(mean_seen(scene, settings, {0, 4, 0}) == doctest::Approx(by_path).epsilon(0.02));
    }
}

TEST_CASE("in a glowing room each scattering counts once, by direct estimate and by final gathering") {
    for (const PhotonGather gather : {PhotonGather::Direct, PhotonGather::Final}) {
        for (const uint32_t nearest : {0u, 100u}) {
            double wanted = 0;
            for (uint32_t depth = 0; depth <= 4; ++depth) {
                CAPTURE(static_cast<int>(gather));
                CAPTURE(nearest);
                CAPTURE(depth);
                wanted += std::pow(0.5, depth);
                RenderSettings settings;
                settings.path.max_depth = depth;
                settings.path.roulette_depth = 100;
                settings.samples = 16;
                settings.photon_map = {.photons = 20'000, .radius = 0.2f, .nearest = nearest, .gather = gather};
                CHECK(mean_seen(sphere_that_glows(0.5f), settings, {0.3f, 0.2f, -0.5f}) ==
                      doctest::Approx(wanted).epsilon(0.02));
            }
        }
    }
}

TEST_CASE("the ray counts of photon mapping, including gathering, equal those computed by hand") {
    const test::TriangleMesh sphere = test::make_sphere(3, {0, 0, 0}, 2.0f);
    Scene room; // closed and white, with a light that is visible everywhere: no subpath ends before its last scattering
    Mesh mesh;
    mesh.positions = sphere.positions;
    mesh.indices = sphere.indices;
    test::add(room, mesh, test::white(1));
    room.lights.push_back(test::point_light({0, 0, 0}, {1, 1, 1}));
    constexpr uint64_t kPasses = 3, kPhotons = 1000, kSamples = kPasses * 8 * 8;
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        for (const PhotonGather gather : {PhotonGather::Direct, PhotonGather::Final}) {
            for (const uint32_t depth : {0u, 1u, 2u, 3u}) {
                RenderSettings settings;
                settings.width = settings.height = 8;
                settings.samples = kPasses;
                settings.integrator = IntegratorKind::PhotonMap;
                settings.body = body;
                settings.path.max_depth = depth;
                settings.path.roulette_depth = 100;
                settings.photon_map = {.photons = kPhotons, .radius = 1e-4f, .gather = gather};
                Queue queue = test::requested_queue();
                const RayCounts rays = test::render(queue, room, test::camera_down({0, 0.1f, 0}, 0.2f), settings).rays;
                CAPTURE(static_cast<int>(gather));
                CAPTURE(depth);
                // A photon has a ray from the light and one from each surface except the last. Without specular
                // surfaces there is one map.
                const uint64_t of_photons = depth < 2 ? 0 : kPasses * kPhotons * depth;
                // A sample traces one camera ray, and one shadow ray from its hit.
                const bool gathers = gather == PhotonGather::Final && depth > 0;
                CHECK(rays.camera == kSamples);
                CHECK(rays.bounce == of_photons + (gathers ? kSamples : 0));
                CHECK(rays.shadow == (depth > 0 ? kSamples : 0) + (gathers && depth > 1 ? kSamples : 0));
            }
        }
    }
}

TEST_CASE("where subpaths end a ray searches for nearby area lights, but not if there are only point lights") {
    for (const PhotonGather gather : {PhotonGather::Direct, PhotonGather::Final}) {
        RenderSettings settings;
        settings.width = settings.height = 16;
        settings.samples = 8;
        settings.integrator = IntegratorKind::PhotonMap;
        settings.path.max_depth = 1; // there are no photons
        settings.photon_map.edit().gather = gather;
        Queue queue = test::requested_queue();
        const auto rays_of = [&](const Scene& scene) {
            return test::render(queue, scene, test::camera_down({0, 0.1f, 0}, 0.2f), settings).rays;
        };
        const RayCounts near = rays_of(sphere_that_glows(0.5f)), points = rays_of(test::floor_under_spot());
        CHECK(near.camera == 16 * 16 * 8);
        CHECK(near.bounce ==
              doctest::Approx(static_cast<double>(near.camera)).epsilon(0.02)); // finds the light in either case
        CHECK(points.bounce == (gather == PhotonGather::Final ? points.camera : 0));
    }
}

TEST_CASE("a sphere in a furnace shows its albedo") {
    RenderSettings settings;
    settings.samples = 64;
    settings.photon_map.edit().photons = 1000;
    CHECK(mean_seen(test::make_furnace_scene(0.6f), settings, {0, 2, 0}) == doctest::Approx(0.6).epsilon(0.01));
}

TEST_CASE("targets are one sphere around a ball and several around separate mirrors") {
    SpecularBounds found;
    std::fill_n(reinterpret_cast<unsigned char*>(&found), sizeof found, hploc::kNothing);
    CHECK(choose_targets(found).empty());
    for (const bool are_apart : {false, true}) {
        Scene scene;
        const Material glass = {{.kind = MaterialKind::Dielectric, .ior = 1.5f}, "glass"};
        for (const float x : {-3.0f, 3.0f}) {
            if (x < 0 && !are_apart) continue;
            const test::TriangleMesh ball = test::make_sphere(2, {x, 0, 0}, 0.5f);
            Mesh mesh;
            mesh.positions = ball.positions;
            mesh.indices = ball.indices;
            test::add(scene, mesh, glass);
            scene.materials.back().roughness = 0;
        }
        test::add(scene, test::floor_at(-1, 4), test::white());
        Messages messages;
        const PreparedScene prepared = prepare_scene(scene, {}, messages);
        Queue queue = Queue::make_cpu();
        const SceneOnDevice device(queue, prepared);
        std::fill_n(reinterpret_cast<unsigned char*>(&found), sizeof found, hploc::kNothing);
        for (const bool in_cells : {false, true}) {
            for (uint32_t i = 0; i < device.view().triangle_count; ++i) {
                FindSpecular{device.view(), &found, in_cells}(i);
            }
        }
        const std::vector<Float4> spheres = choose_targets(found);
        if (!are_apart) {
            REQUIRE(spheres.size() == 1);
            CHECK(spheres[0].w == doctest::Approx(0.5).epsilon(0.01));
        }
        CHECK(spheres.size() >= (are_apart ? 2u : 1u));
        double area = 0;
        for (const Float4& sphere : spheres) area += static_cast<double>(sphere.w) * static_cast<double>(sphere.w);
        CHECK(area < 4);                      // one sphere around both would have 3.5^2
        for (const float x : {-3.0f, 3.0f}) { // each ball lies in one of the spheres
            if (x < 0 && !are_apart) continue;
            for (const Vec3 at : test::make_sphere(2, Vec3{x, 0, 0} - prepared.centre, 0.5f).positions) {
                CHECK(std::ranges::any_of(spheres, [&](const Float4& sphere) {
                    return length(at - Vec3{sphere.x, sphere.y, sphere.z}) <= sphere.w;
                }));
            }
        }
    }
}

TEST_CASE("scenes without lights, and too many photons, are refused") {
    Scene scene;
    test::add(scene, test::floor_at(0, 1), test::white());
    RenderSettings settings;
    settings.integrator = IntegratorKind::PhotonMap;
    Messages messages;
    const auto message = [&] { return test::bad_input_message([&] { check_light(settings, scene, messages); }); };
    CHECK(message().starts_with("`integrator=photon_map`: "));
    scene.lights.push_back(test::point_light({0, 2, 0}, {1, 1, 1}));
    CHECK(message() == "no error");
    scene.lights.clear();
    settings.path.max_depth = 0; // shows only emission
    CHECK(message() == "no error");

    settings.path.max_depth = 64;
    settings.photon_map.edit().photons = kMaxPhotons;
    const auto error = test::thrown_error([&] { check_integrator(settings); });
    CHECK(test::is_about(error, ErrorCode::OverLimit, "photons", "16777216"));
    CHECK(test::says(error, "the limit is 8521760"));
    settings.path.max_depth = 65;
    const auto too_deep = test::thrown_error([&] { check_integrator(settings); });
    CHECK(test::is_about(too_deep, ErrorCode::OverLimit, "max_depth", "65"));
}
