// The exposure metered before a render, and its invariance to other settings.

#include <doctest/doctest.h>

#include "image/tone_map_image.h"
#include "math/portable_math.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

float stops_of(Queue& queue, const Scene& scene, const Camera& camera, const RenderSettings& settings,
               ToneMap tone_map = ToneMap::Agx) {
    Messages messages;
    return Session(queue, prepare_scene(scene, {}, messages), camera, settings).meter(tone_map);
}

void add_quad(Scene& scene, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    Mesh mesh;
    mesh.positions = {a, b, c, d};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes.push_back(std::move(mesh));
    scene.instances.push_back({"", static_cast<uint32_t>(scene.meshes.size() - 1), 0, {}});
}

/// A white room, 4 m wide, 3 high and 5 deep, under a sky of radiance 50. Its far wall, at z = -5, has a window of 2 by
/// 1.4 m, which fills an eighth of the camera's picture.
Scene make_room_with_window() {
    Scene scene;
    scene.materials.push_back({{.base_color = grey(0.7f)}, "white"});
    const float l = -2, r = 2, h = 3, n = 0, f = -5;   // left, right, height, near, far
    const float wl = -1, wr = 1, wb = 0.8f, wt = 2.2f; // the sides of the window
    add_quad(scene, {l, 0, n}, {r, 0, n}, {r, 0, f}, {l, 0, f});
    add_quad(scene, {l, h, f}, {r, h, f}, {r, h, n}, {l, h, n});
    add_quad(scene, {l, 0, n}, {l, 0, f}, {l, h, f}, {l, h, n});
    add_quad(scene, {r, 0, f}, {r, 0, n}, {r, h, n}, {r, h, f});
    add_quad(scene, {r, 0, n}, {l, 0, n}, {l, h, n}, {r, h, n});
    add_quad(scene, {l, 0, f}, {wl, 0, f}, {wl, h, f}, {l, h, f});
    add_quad(scene, {wr, 0, f}, {r, 0, f}, {r, h, f}, {wr, h, f});
    add_quad(scene, {wl, 0, f}, {wr, 0, f}, {wr, wb, f}, {wl, wb, f});
    add_quad(scene, {wl, wt, f}, {wr, wt, f}, {wr, h, f}, {wl, h, f});
    scene.environment = Environment{};
    scene.environment->scale = grey(50);
    return scene;
}

Camera camera_at(Vec3 eye, Vec3 target) {
    Camera camera;
    camera.world_from_camera = look_at(eye, target, {0, 1, 0});
    camera.fov_y = 0.9f;
    return camera;
}

RenderSettings metered_settings() {
    RenderSettings settings;
    settings.width = 64, settings.height = 36, settings.samples = 64;
    return settings;
}

/// Tones of the pixels that show surfaces other than emitters.
struct Shown {
    double mean = 0, burnt = 0; // the mean, in [0, 1], and the share of all pixels that are clipped
};

Shown show_surfaces(Queue& queue, const Scene& scene, const Camera& camera, float stops) {
    RenderSettings settings = metered_settings();
    const Rgba8Image shown = tone_map_image(test::render(queue, scene, camera, settings).picture, ToneMap::Agx, stops);
    settings.path.max_depth = 0;
    settings.transparent = true; // alpha: share of hits
    const Image emitted = test::render(queue, scene, camera, settings).picture;
    const std::size_t pixels = emitted.pixels.size() / 4;
    Shown result;
    double surfaces = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        if (emitted.pixels[4 * i + 1] > 0 || emitted.pixels[4 * i + 3] < 1) continue;
        const uint8_t* pixel = &shown.pixels[4 * i];
        surfaces += 1;
        result.mean += pixel[1] / 255.0;
        result.burnt += pixel[0] == 255 && pixel[1] == 255 && pixel[2] == 255;
    }
    result.mean /= surfaces;
    result.burnt /= static_cast<double>(pixels);
    return result;
}

} // namespace

TEST_CASE("samples, seed, sampler, filter, size, time and alpha do not move the exposure") {
    Queue queue = test::requested_queue();
    const Scene scene = test::make_mixed_scene();
    const Camera camera = test::mixed_scene_camera();
    const RenderSettings settings = metered_settings();
    const float stops = stops_of(queue, scene, camera, settings);
    CHECK(stops != 0);
    RenderSettings other = settings;
    other.width = 1280, other.height = 720, other.samples = 1, other.filter = PixelFilter::Tent,
    other.filter_radius = 3;
    other.transparent = true, other.time_limit_s = 1e-9, other.aovs = kAovAlbedo;
    other.path.sampler = SamplerKind::Independent;
    for (uint32_t seed = 0; seed < 5; ++seed) { // by chance two pictures may round to one hundredth
        other.path.seed = seed;
        CHECK(stops_of(queue, scene, camera, other) == stops);
    }
    other = settings;
    other.path.max_depth = 1; // this setting makes another picture
    CHECK(stops_of(queue, scene, camera, other) != stops);
}

TEST_CASE("the meter gives the same exposure on the GPU and the CPU") {
    if (!test::cuda_requested()) return;
    Queue cpu = Queue::make_cpu(), cuda = test::make_cuda_queue();
    const Scene scene = test::make_mixed_scene();
    const RenderSettings settings = metered_settings();
    for (const ToneMap tone_map : {ToneMap::Agx, ToneMap::Srgb}) {
        CHECK(stops_of(cpu, scene, test::mixed_scene_camera(), settings, tone_map) ==
              stops_of(cuda, scene, test::mixed_scene_camera(), settings, tone_map));
    }
}

TEST_CASE("a room with a bright window stays legible") {
    Queue queue = test::requested_queue();
    const Scene scene = make_room_with_window();
    const Camera camera = camera_at({0, 1.5f, -0.3f}, {0, 1.5f, -5});
    const Shown room = show_surfaces(queue, scene, camera, stops_of(queue, scene, camera, metered_settings()));
    CHECK(room.mean > 0.42); // AgX shows middle grey as 0.5
    CHECK(room.mean < 0.62);
    CHECK(room.burnt <= 0.01);
}

TEST_CASE("a visible emitter does not darken what it lights") {
    Queue queue = test::requested_queue();
    Scene scene; // a white floor fills the lower half of the picture, and an emitter much of the upper half
    scene.materials.push_back({{.base_color = grey(0.5f)}, "white"});
    scene.materials.push_back({{.base_color = grey(0), .emission = grey(300)}, "lamp"});
    add_quad(scene, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}, {-9, 0, -9});
    add_quad(scene, {-2, 1.5f, -4}, {2, 1.5f, -4}, {2, 4, -4}, {-2, 4, -4});
    scene.instances.back().material = 1;
    const Camera camera = camera_at({0, 1, 3}, {0, 1, 0});
    const Shown floor = show_surfaces(queue, scene, camera, stops_of(queue, scene, camera, metered_settings()));
    CHECK(floor.mean > 0.42);
    CHECK(floor.burnt <= 0.01);
}

TEST_CASE("if only sky is visible, it becomes middle grey") {
    Queue queue = test::requested_queue();
    Scene scene = make_room_with_window();
    scene.environment->scale = grey(0.72f);
    CHECK(stops_of(queue, scene, camera_at({0, 1, -9}, {0, 1, -20}), metered_settings()) == -2.0f);
}

TEST_CASE("a patch of sunlight on the floor is not clipped") {
    Queue queue = test::requested_queue();
    Scene scene = make_room_with_window();
    scene.lights.push_back({.name = "sun",
                            .kind = LightKind::Directional,
                            .direction = normalize(Vec3{0.2f, -1, 0.9f}),
                            .intensity = grey(20'000)});
    const Camera camera = camera_at({0, 1.5f, -0.3f}, {0, 1.2f, -5});
    const Shown room = show_surfaces(queue, scene, camera, stops_of(queue, scene, camera, metered_settings()));
    CHECK(room.burnt <= 0.01);
    CHECK(room.mean > 0.25);
}
