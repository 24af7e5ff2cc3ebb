// The integrator hybrid rasterises the first hit, and its picture equals path's to the byte for all filters, views,
// transforms, surfaces, threads and batches. With --device cuda the GPU renders, too.

#include <doctest/doctest.h>

#include "base/parallel_for.h"
#include "render/raster/camera_raster.h"
#include "session/opening/choose_camera.h"
#include "session/opening/open_scene.h"
#include "session/session.h"
#include "session/session_bytes.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/render_scenes.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

RenderSettings hybrid_settings() {
    RenderSettings settings;
    settings.width = 37; // not a multiple of a tile
    settings.height = 21;
    settings.samples = 3;
    settings.aovs = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;
    settings.integrator = IntegratorKind::Hybrid;
    settings.path.max_depth = 2;
    return settings;
}

/// The picture, layers and ids of hybrid and path.
void check_as_path(const Scene& scene, const Camera& camera, RenderSettings settings) {
    Queue queue = test::requested_queue();
    settings.integrator = IntegratorKind::Hybrid;
    const RenderResult hybrid = test::render(queue, scene, camera, settings);
    settings.integrator = IntegratorKind::Path;
    const RenderResult path = test::render(queue, scene, camera, settings);
    CHECK(test::render_hash(hybrid) == test::render_hash(path));
    CHECK(hybrid.rays.total() == path.rays.total());
}

/// Triangles of all sizes around the origin, including slivers, points and duplicates. Some contain the origin.
Mesh soup(uint32_t count, uint32_t seed) {
    test::Random random(seed);
    Mesh mesh;
    for (uint32_t i = 0; i < count; ++i) {
        const float size = 4 * square(square(random.unit()));
        const Vec3 a = random.point(-3, 3);
        for (int k = 0; k < 3; ++k) {
            const bool is_flat = i % 17 == 0 && k == 2;
            mesh.positions.push_back(is_flat ? mesh.positions.back() : a + size * random.point(-1, 1));
        }
        const uint32_t first = 3 * i;
        mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2});
        if (i % 13 == 0) mesh.indices.insert(mesh.indices.end(), {first + 1, first + 2, first}); // a duplicate
    }
    return mesh;
}

Scene soup_scene(uint32_t count, uint32_t seed) {
    Scene scene;
    scene.environment = Environment{};
    test::add(scene, soup(count, seed), test::white(0.5f));
    return scene;
}

/// Returns `count` triangles of `size` within `spread` of `middle`.
Scene scattered_triangles(uint32_t count, Vec3 middle, float spread, float size) {
    test::Random random(count);
    Mesh mesh;
    for (uint32_t i = 0; i < 3 * count; ++i) {
        const Vec3 near = i % 3 == 0 ? middle + spread * random.point(-1, 1) : mesh.positions[i - i % 3];
        mesh.positions.push_back(i % 3 == 0 ? near : near + size * random.point(-1, 1));
        mesh.indices.push_back(i);
    }
    Scene scene;
    scene.environment = Environment{};
    test::add(scene, mesh, test::white(0.5f));
    return scene;
}

Camera camera_at(Vec3 eye, Vec3 target, float fov_y) {
    Camera camera;
    camera.fov_y = fov_y;
    camera.world_from_camera = look_at(eye, target, {0, 1, 0});
    return camera;
}

} // namespace

TEST_CASE("hybrid has the path tracer's picture of all kinds of surfaces, for any threads, schedule and batch size") {
    const Scene scene = test::make_mixed_scene(); // cut-outs, blended sheets, hidden backs, instances
    const Camera camera = test::mixed_scene_camera();
    RenderSettings settings = hybrid_settings();
    settings.path.max_depth = 5;
    settings.integrator = IntegratorKind::Path;
    Queue queue = Queue::make_cpu();
    const Hash128 expected = test::render_hash(test::render(queue, scene, camera, settings));
    settings.integrator = IntegratorKind::Hybrid;
    const auto check = [&](Queue& on) {
        CHECK(test::render_hash(test::render(on, scene, camera, settings)) == expected);
    };
    check(queue);
    for (const int threads : {1, 5}) {
        settings.pass_samples = 2;
        Queue few = Queue::make_cpu(Threads(threads));
        check(few);
    }
    settings.body = PathBody::Wavefront;
    for (const uint32_t batch : {333u, 1u << 20}) {
        settings.batch = batch;
        check(queue);
        if (!test::cuda_requested()) continue;
        Queue gpu = test::make_cuda_queue();
        check(gpu);
    }
}

TEST_CASE("hybrid has path tracing's denoised picture and irradiance") {
    const Scene scene = test::make_mixed_scene();
    RenderSettings settings = hybrid_settings();
    settings.denoise = Denoise::Svgf;
    check_as_path(scene, test::mixed_scene_camera(), settings);
    settings.denoise = Denoise::None;
    settings.irradiance = true;
    check_as_path(scene, test::mixed_scene_camera(), settings);
}

TEST_CASE("hybrid has the path tracer's picture with any pixel filter, field of view and position") {
    const Scene scene = soup_scene(150, 1);
    for (const auto& [filter, radius] : {std::pair(PixelFilter::Box, 0.5f), std::pair(PixelFilter::Tent, 3.0f),
                                         std::pair(PixelFilter::Gaussian, 17.0f)}) {
        RenderSettings settings = hybrid_settings();
        settings.filter = filter;
        settings.filter_radius = radius;
        check_as_path(scene, camera_at({0, 0, 0}, {1, 0.2f, 0.1f}, 1), settings); // among triangles
    }
    for (const float fov_y : {1e-5f, 0.01f, 3.1f}) {
        check_as_path(scene, camera_at({0, 0, 0}, {0.3f, 0.2f, -1}, fov_y), hybrid_settings());
        check_as_path(scene, camera_at({0, 0, 20}, {0.3f, 0.2f, -1}, fov_y), hybrid_settings());
    }
    Camera flat = test::camera_down({0, 1, 0}, 5); // with triangles in front of and behind it
    check_as_path(scene, flat, hybrid_settings());
    flat.ortho_height = 1e-3f;
    check_as_path(scene, flat, hybrid_settings());
}

// Triangles at the border of a tile. The test fails if tiles are enlarged by less than the filter's radius and
// rounding.
TEST_CASE("hybrid finds every triangle that a sample hits outside its tile") {
    RenderSettings settings = hybrid_settings();
    settings.width = 96, settings.height = 64;
    settings.samples = 4;
    settings.path.max_depth = 0;
    settings.filter = PixelFilter::Box;
    const Camera camera = camera_at({0.3f, 0.2f, 4}, {0.1f, 0, 0}, 0.6f);
    for (const float radius : {0.5f, 4.0f}) {
        settings.filter_radius = radius;
        check_as_path(scattered_triangles(2500, {0, 0, 0}, 2, 0.02f), camera, settings);
    }
    // Triangles of a few pixels in a view of 1e-5 degrees are at the limit of a float's precision, for positions
    // (baked or instanced) and rays.
    settings.filter_radius = 0.5f;
    settings.samples = 2;
    const Vec3 middle = {0.7f, 0.3f, -0.6f}, eye = {-0.2f, 0.9f, 0.4f};
    for (const float scale : {1.0f, 30.0f}) {
        const Camera narrow = camera_at(eye, middle, 1e-5f * scale);
        Scene fine = scattered_triangles(1000, middle, 1e-5f * scale, 1e-6f * scale);
        check_as_path(fine, narrow, settings);
        fine.bakes_small_meshes = false;
        fine.instances.push_back(fine.instances.front()); // now no mesh is baked
        check_as_path(fine, narrow, settings);
    }
}

TEST_CASE("hybrid has the path tracer's picture of triangles close to the camera, in its plane or touching it") {
    test::Random random(3);
    for (int i = 0; i < 12; ++i) {
        Scene scene = soup_scene(60, 100 + static_cast<uint32_t>(i));
        const Mesh& mesh = scene.meshes.front();
        const Vec3 corner = mesh.positions[random.below(60)], other = mesh.positions[random.below(60)];
        Vec3 eye = corner; // at a vertex, on an edge, just off a triangle, and in a triangle's plane
        if (i % 4 == 1) eye = 0.5f * (corner + other);
        if (i % 4 == 2) eye = corner + Vec3{1e-6f, -1e-6f, 2e-6f};
        if (i % 4 == 3) eye = mesh.positions[0] + 2.0f * (mesh.positions[0] - mesh.positions[1]);
        check_as_path(scene, camera_at(eye, eye + random.direction(), 1.2f), hybrid_settings());
    }
}

TEST_CASE("hybrid has the path tracer's picture of rotated, mirrored, squeezed and distant instances") {
    Scene scene = soup_scene(12, 5);
    scene.bakes_small_meshes = false;
    const Mesh mesh = soup(25, 6);
    scene.meshes.push_back(mesh);
    test::Random random(7);
    for (int i = 0; i < 24; ++i) {
        Instance instance;
        instance.mesh = 1;
        const Vec3 axis = random.direction();
        const float turn = random.within(0, 3);
        instance.world_from_local =
            compose(make_translation(random.point(-6, 6)),
                    compose(make_rotation(axis.x * sin(turn), axis.y * sin(turn), axis.z * sin(turn), cos(turn)),
                            make_scale({i % 3 == 0 ? -0.5f : 0.5f, i % 5 == 0 ? 0.002f : 0.7f, 0.4f})));
        instance.is_hidden = i == 4;
        scene.instances.push_back(instance);
        if (i % 6 == 0) scene.instances.push_back(instance); // identical triangles: the lower number is hit
    }
    check_as_path(scene, camera_at({0, 0, 9}, {0, 0, 0}, 1), hybrid_settings());
    check_as_path(scene, camera_at({0, 0, 0}, {1, 1, 0}, 1.5f), hybrid_settings());
    for (Instance& instance : scene.instances) { // 100 km away, where floats are 8 mm apart
        instance.world_from_local = compose(make_translation({1e5f, 0, -1e5f}), instance.world_from_local);
    }
    scene.instances.push_back(scene.instances.front());
    scene.instances.back().world_from_local = Transform{}; // so that the world is not translated
    check_as_path(scene, camera_at({1e5f, 0, -1e5f + 9}, {1e5f, 0, -1e5f}, 1), hybrid_settings());
}

TEST_CASE("where the lists of tiles exceed their memory, tiles become larger and the picture stays the same") {
    Scene scene;
    scene.environment = Environment{};
    Mesh sheets;
    for (int i = 0; i < 300; ++i) { // each triangle covers the whole picture
        const Mesh sheet =
            test::sheet({0, 0, -1.0f - 0.01f * static_cast<float>((i * 37) % 300)}, {9, 0, 0}, {0, 9, 0});
        for (const uint32_t index : sheet.indices) {
            sheets.indices.push_back(index + static_cast<uint32_t>(sheets.positions.size()));
        }
        sheets.positions.insert(sheets.positions.end(), sheet.positions.begin(), sheet.positions.end());
    }
    test::add(scene, sheets, test::white(0.5f));
    check_as_path(scene, Camera{}, hybrid_settings());
    check_as_path(Scene{.environment = Environment{}}, Camera{}, hybrid_settings()); // no triangle is visible
}

TEST_CASE("hybrid has the path tracer's picture of public scenes") {
    for (const char* name :
         {"crytek-sponza/sponza.obj", "sibenik/sibenik.obj", "gltf/SimpleInstancing/SimpleInstancing.glb",
          "gltf/NegativeScaleTest/NegativeScaleTest.glb", "gltf/AlphaBlendModeTest/AlphaBlendModeTest.glb",
          "gltf/SimpleSkin/SimpleSkin.gltf"}) {
        const auto path = test::test_scene(name);
        if (!path) continue;
        CAPTURE(name);
        Messages messages;
        const Scene scene = open_scene(path->string(), messages);
        RenderSettings settings = hybrid_settings();
        settings.width = 160, settings.height = 90, settings.samples = 1;
        settings.path.max_depth = 1;
        const Camera camera = choose_camera({}, scene, 16.0f / 9, messages);
        check_as_path(scene, camera, settings);
    }
}

TEST_CASE("memory of hybrid equals its prediction, and other cameras and sizes give new pictures") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    RenderSettings settings = hybrid_settings();
    settings.body = PathBody::Wavefront;
    Queue queue = test::requested_queue();
    Session session(queue, prepared, test::mixed_scene_camera(), settings);
    session.render(settings.samples);
    const std::size_t predicted = predicted_bytes(prepared, settings, queue.is_cuda());
    const std::size_t sorting = queue.is_cuda() ? predicted / 10 : 0; // on a GPU CUB determines the sorting memory
    CHECK(queue.allocated_bytes() + sorting >= predicted);
    CHECK(queue.allocated_bytes() <= predicted + 4096 + sorting); // the filter's table, the scene's view
    Camera camera = test::mixed_scene_camera();
    camera.world_from_camera = compose(make_translation({0.5f, 0.2f, 0}), camera.world_from_camera);
    for (const uint32_t width : {37u, 64u, 11u}) {
        settings.width = width;
        session.set_settings(settings);
        session.set_camera(camera);
        session.render(settings.samples);
        CHECK(test::render_hash(session.result()) == test::render_hash(test::render(queue, scene, camera, settings)));
    }
}

TEST_CASE("hybrid refuses a lens") {
    const Scene scene = test::make_furnace_scene(0.5f);
    Camera camera;
    Queue queue = Queue::make_cpu();
    camera.aperture_radius = 0.01f;
    const auto is_refused = [](const auto& body) {
        return test::is_about(test::thrown_error(body), ErrorCode::BadInput, "integrator", "hybrid");
    };
    CHECK(is_refused([&] { test::render(queue, scene, camera, hybrid_settings()); }));
    Messages messages;
    Session session(queue, prepare_scene(scene, {}, messages), {}, hybrid_settings());
    session.set_camera(camera);
    CHECK(is_refused([&] { session.render(1); }));
    session.set_camera({});
    CHECK(session.render(1) == 1);
}
