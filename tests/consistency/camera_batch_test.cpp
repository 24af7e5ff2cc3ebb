// Batches of pictures: each picture has the bytes of a single render with its camera, for all chunks, threads,
// schedules and devices. With --device cuda the GPU renders.

#include <doctest/doctest.h>

#include <algorithm>

#include "base/parallel_for.h"
#include "session/batch_render.h"
#include "session/moving_scene.h"
#include "session/session.h"
#include "tests/support/flat_scenes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tests/support/rushing_scene.h"
#include "tests/support/solid_scenes.h"
#include "tests/support/stop_after.h"
#include "tests/support/thrown_error.h"

using namespace pertev;

namespace {

constexpr uint32_t kAllLayers = kAovAlbedo | kAovNormal | kAovDepth | kAovPosition | kAovIds;

/// Cameras of different kinds in the mixed scene: one that moves and has a lens, one without perspective, a pinhole.
CameraBatch three_cameras() {
    Camera parallel = test::mixed_scene_camera();
    parallel.projection = Projection::Orthographic;
    parallel.ortho_height = 4;
    return {{test::rushing_camera(), parallel, test::mixed_scene_camera()}, {7, 0, 7}};
}

RenderSettings batch_settings(LayersAt layers_at) {
    RenderSettings settings;
    settings.width = 19, settings.height = 11; // not a multiple of a tile
    settings.samples = 3;
    settings.path.max_depth = 4;
    settings.aovs = kAllLayers;
    settings.layers_at = layers_at;
    return settings;
}

/// Returns the part of an array that belongs to picture `number` of a chunk.
template <class T>
std::vector<T> part_of_picture(const Buffer<T>& buffer, uint32_t number, std::size_t size) {
    const std::vector<T> all = buffer.download();
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(number * size);
    return {first, first + static_cast<std::ptrdiff_t>(size)};
}

/// Returns the hash of a picture of a chunk, computed like render_hash() of a single picture.
Hash128 hash_of(const BatchArrays& arrays, uint32_t number, const RenderSettings& settings) {
    const std::size_t pixels = std::size_t(settings.width) * settings.height;
    const uint32_t channels = settings.transparent ? 4 : 3;
    RenderResult result;
    result.picture = {settings.width, settings.height, channels,
                      part_of_picture(arrays.color, number, pixels * channels)};
    for (const BatchArrays::Layer& layer : arrays.layers) {
        const AovGroup& group = aov_group(layer.group);
        result.layers.push_back({group.layer,
                                 channel_names(group),
                                 {settings.width, settings.height, layer.channels,
                                  part_of_picture(layer.values, number, pixels * layer.channels)}});
    }
    if (arrays.ids.size() > 0) result.ids = part_of_picture(arrays.ids, number, pixels);
    return test::render_hash(result);
}

/// A scene on a device.
struct Pictures {
    DeviceScene scene;
    PictureRenderer pictures;
    Pictures(Queue& queue, const PreparedScene& prepared, const RenderSettings& settings)
        : scene(queue), pictures(scene) {
        scene.set(prepared, settings);
    }
};

std::vector<Hash128> hashes_of(Queue& queue, const PreparedScene& prepared, const CameraBatch& batch,
                               const RenderSettings& settings, uint32_t at_once) {
    Pictures on(queue, prepared, settings);
    BatchRender render(on.pictures, batch, settings, at_once);
    std::vector<Hash128> hashes;
    for (BatchArrays arrays; render.next(arrays);) {
        CHECK(arrays.first == hashes.size());
        for (uint32_t k = 0; k < arrays.pictures; ++k) hashes.push_back(hash_of(arrays, k, settings));
    }
    CHECK(render.done() == batch.count());
    CHECK(render.invalid_samples() == 0);
    return hashes;
}

/// Returns the hashes of single renders of the cameras.
std::vector<Hash128> hashes_alone(Queue& queue, const PreparedScene& prepared, const CameraBatch& batch,
                                  RenderSettings settings) {
    std::vector<Hash128> hashes;
    for (uint32_t k = 0; k < batch.count(); ++k) {
        settings.path.seed = batch.seed_of(k, settings);
        hashes.push_back(test::render_hash(render_picture(queue, prepared, batch.cameras[k], settings)));
    }
    return hashes;
}

} // namespace

TEST_CASE("each picture of a batch has the hash of a single render, for any chunks, threads and schedule") {
    Messages messages;
    MovingScene moving(test::make_rushing_scene(), 0.3, {}, messages, test::kHalfASecond);
    MovingScene still(test::make_rushing_scene(false), 0.3, {}, messages, test::kHalfASecond);
    const Scene furnace = test::make_furnace_scene(0.5f); // plain diffuse surfaces, which a CPU shades in lanes
    const PreparedScene plain = prepare_scene(furnace, {}, messages);
    const CameraBatch batch = three_cameras();
    Queue cpu = Queue::make_cpu();
    for (const PreparedScene* prepared : {&moving.prepared(), &still.prepared(), &plain}) {
        for (const LayersAt layers_at : {LayersAt::Samples, LayersAt::Centre}) {
            RenderSettings settings = batch_settings(layers_at);
            settings.transparent = prepared == &still.prepared();
            const std::vector<Hash128> alone = hashes_alone(cpu, *prepared, batch, settings);
            CHECK(alone[0] != alone[2]);
            for (const uint32_t at_once : {1u, 2u, 3u}) {
                CAPTURE(at_once);
                CHECK(hashes_of(cpu, *prepared, batch, settings, at_once) == alone);
            }
            for (const int threads : {1, 3}) {
                Queue few = Queue::make_cpu(Threads(threads));
                CHECK(hashes_of(few, *prepared, batch, settings, 3) == alone);
            }
            settings.body = PathBody::Wavefront;
            settings.batch = 333; // paths in flight
            CHECK(hashes_of(cpu, *prepared, batch, settings, 3) == alone);
            if (!test::cuda_requested()) continue;
            Queue gpu = test::make_cuda_queue();
            for (const uint32_t paths : {333u, 1u << 20}) {
                settings.batch = paths;
                for (const uint32_t at_once : {2u, 3u}) {
                    CHECK(hashes_of(gpu, *prepared, batch, settings, at_once) == alone);
                }
            }
        }
    }
}

TEST_CASE("each camera of a batch knows the nested solids that hold it") {
    Messages messages;
    Scene scene;
    scene.environment = test::make_mixed_scene().environment;
    Material amber = test::glass(1.5f);
    amber.transmission_color = {0.9f, 0.5f, 0.1f};
    amber.transmission_depth = 0.5f;
    test::add(scene, test::ball({0, 0, 0}, 1), amber);
    test::add(scene, test::ball({0.3f, 0, 0}, 0.4f), test::glass(1));
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    CameraBatch batch;
    for (const Vec3 eye : {Vec3{-0.5f, 0, 0}, Vec3{0.3f, 0, 0}, Vec3{0, 1, 3}}) {
        Camera camera;
        camera.world_from_camera = look_at(eye, {0.2f, 0.1f, -0.3f}, {0, 1, 0});
        batch.cameras.push_back(camera);
    }
    batch.seeds = {1, 2, 3};
    RenderSettings settings = batch_settings(LayersAt::Samples);
    Queue queue = test::requested_queue();
    for (const PathBody body : {PathBody::Loop, PathBody::Wavefront}) {
        settings.body = body;
        CHECK(hashes_of(queue, prepared, batch, settings, 2) == hashes_alone(queue, prepared, batch, settings));
    }
}

TEST_CASE("integrators without batches render the pictures one after the other, with the same bytes") {
    const Scene scene = test::make_mixed_scene();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    CameraBatch batch = three_cameras();
    batch.cameras[0].motion.clear();
    batch.cameras.push_back(batch.cameras[2]); // this picture occurs twice
    batch.seeds = {3};
    for (const IntegratorKind integrator : {IntegratorKind::Whitted, IntegratorKind::Bidirectional}) {
        RenderSettings settings = batch_settings(LayersAt::Centre);
        settings.integrator = integrator;
        CHECK(hashes_of(queue, prepared, batch, settings, 3) == hashes_alone(queue, prepared, batch, settings));
    }
}

TEST_CASE("a depth at a pixel's centre unprojects onto the visible plane") {
    Scene scene;
    test::add(scene, test::floor_at(0, 8), test::white());
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Camera camera;
    camera.world_from_camera = look_at({0.3f, 1.4f, 0.2f}, {0.5f, 0, -1.5f}, {0, 1, 0});
    Queue queue = test::requested_queue();
    RenderSettings settings = batch_settings(LayersAt::Centre);
    settings.width = 64, settings.height = 48, settings.samples = 4;
    settings.path.max_depth = 0;
    /// Returns the largest height of an unprojected point over the plane, metres.
    const auto error_of = [&](const RenderResult& result) {
        const CameraView view = make_camera_view(camera, settings.width, settings.height);
        const Image& depths = layer_named(result, "depth");
        float error = 0;
        for (uint32_t pixel = 0; pixel < settings.width * settings.height; ++pixel) {
            const Vec2 centre = {static_cast<float>(pixel % settings.width) + 0.5f,
                                 static_cast<float>(pixel / settings.width) + 0.5f};
            const Vec3 point = unproject_point(view, centre, depths.pixels[pixel]);
            error = std::max(error, std::abs(transform_point(camera.world_from_camera, point).y));
        }
        return error;
    };
    const RenderResult at_centre = render_picture(queue, prepared, camera, settings);
    CHECK(error_of(at_centre) < 1e-5f);
    settings.layers_at = LayersAt::Samples;
    CHECK(error_of(render_picture(queue, prepared, camera, settings)) > 1e-3f);

    // Samples, filter and lens do not change them.
    settings.layers_at = LayersAt::Centre;
    settings.samples = 1;
    settings.filter = PixelFilter::Box;
    camera.aperture_radius = 0.1f;
    const RenderResult blurred = render_picture(queue, prepared, camera, settings);
    for (std::size_t k = 0; k < at_centre.layers.size(); ++k) {
        CHECK(blurred.layers[k].image.pixels == at_centre.layers[k].image.pixels);
    }
}

TEST_CASE("films of samples with layers at centres add up to the film of all samples") {
    const Scene scene = test::make_mixed_scene();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    const RenderSettings settings = batch_settings(LayersAt::Centre);
    const Camera camera = test::mixed_scene_camera();
    Pictures on(queue, prepared, settings);
    FilmRender all(on.pictures, camera, settings), none(on.pictures, camera, settings),
        first(on.pictures, camera, settings), last(on.pictures, camera, settings);
    REQUIRE(all.render({0, 3}) == 3);
    REQUIRE(first.render({0, 1}) == 1);
    REQUIRE(last.render({1, 3}) == 2);
    none.film().add(first.film());
    none.film().add(last.film());
    const auto hash = [&](FilmRender& render) {
        RenderResult result;
        result.picture = render.picture();
        result.layers = render.layers();
        result.ids = render.film().ids();
        return test::render_hash(result);
    };
    CHECK(hash(none) == hash(all));
    CHECK(hash(last) != hash(all));
}

TEST_CASE("each denoised picture of a batch has the bytes of a single denoised render") {
    Messages messages;
    const Scene scene = test::make_mixed_scene();
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    CameraBatch batch = three_cameras();
    batch.cameras.front() = batch.cameras.back(); // a moving camera supports no denoising
    Queue queue = test::requested_queue();
    for (const bool transparent : {false, true}) {
        for (const LayersAt layers_at : {LayersAt::Samples, LayersAt::Centre}) {
            RenderSettings settings = batch_settings(layers_at);
            settings.transparent = transparent;
            settings.denoise = Denoise::Svgf;
            std::vector<Hash128> alone;
            for (uint32_t k = 0; k < batch.count(); ++k) {
                settings.path.seed = batch.seed_of(k, settings);
                RenderResult result = render_picture(queue, prepared, batch.cameras[k], settings);
                CHECK(result.picture.pixels != result.denoised.value().pixels);
                result.picture = *result.denoised;
                alone.push_back(test::render_hash(result));
            }
            for (const uint32_t at_once : {1u, 2u}) {
                CHECK(hashes_of(queue, prepared, batch, settings, at_once) == alone);
            }
        }
    }
}

TEST_CASE("a batch takes the memory that was predicted, and a limit makes its chunks smaller") {
    const Scene scene = test::make_mixed_scene();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    const CameraBatch batch = three_cameras();
    for (const uint32_t samples : {0u, 2u}) {
        for (const LayersAt layers_at : {LayersAt::Centre, LayersAt::Samples}) {
            for (const auto& [integrator, denoise] : {std::pair(IntegratorKind::Path, Denoise::None),
                                                      {IntegratorKind::Distributed, Denoise::None},
                                                      {IntegratorKind::Path, Denoise::Svgf}}) {
                if (samples == 0 && (layers_at == LayersAt::Samples || denoise != Denoise::None)) continue;
                Queue queue = test::requested_queue();
                RenderSettings settings = batch_settings(layers_at);
                settings.width = 64, settings.height = 64;
                settings.integrator = integrator;
                settings.denoise = denoise;
                settings.samples = samples;
                CameraBatch few = batch;
                if (denoise != Denoise::None)
                    few.cameras.front() = few.cameras.back(); // a moving camera supports no denoising
                const std::size_t predicted = predicted_batch_bytes(prepared, few, settings, 2, queue.is_cuda());
                Pictures on(queue, prepared, settings);
                BatchRender render(on.pictures, few, settings, 2);
                BatchArrays arrays;
                while (render.next(arrays)) {
                }
                CHECK(queue.peak_bytes() >= predicted);
                CHECK(queue.peak_bytes() <= predicted + 4096); // the filter's table, the scene's view
            }
        }
    }
    const RenderSettings settings = batch_settings(LayersAt::Centre);
    CHECK(pictures_at_once(prepared, batch, settings, SIZE_MAX, false) == 3);
    const std::size_t of_two = predicted_batch_bytes(prepared, batch, settings, 2, false);
    CHECK(pictures_at_once(prepared, batch, settings, of_two, false) == 2);
    CHECK(pictures_at_once(prepared, batch, settings, of_two - 1, false) == 1);
    CHECK(pictures_at_once(prepared, batch, settings, 0, false) == 1);
    Queue queue = test::requested_queue();
    const Buffer<float> taken(queue, 1 << 20, "of the test");
    CHECK(batch_memory(queue, settings, 12345).bytes == 12345);
    const std::size_t of_cpu = memory_to_render_in(queue, settings, {}).bytes;
    CHECK(batch_memory(queue, settings, {}).bytes ==
          (queue.is_cuda() ? queue.free_bytes() + queue.allocated_bytes() : of_cpu));
}

TEST_CASE("a stopped batch resumes with the chunk that it stopped in, and a caller may keep arrays") {
    const Scene scene = test::make_mixed_scene();
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = Queue::make_cpu();
    const CameraBatch batch = three_cameras();
    const RenderSettings settings = batch_settings(LayersAt::Samples);
    const std::vector<Hash128> alone = hashes_alone(queue, prepared, batch, settings);
    Pictures on(queue, prepared, settings);
    BatchRender render(on.pictures, batch, settings, 2);
    BatchArrays arrays;
    test::StopAfter stops(0);
    CHECK(!render.next(arrays, stops));
    CHECK(render.done() == 0);
    REQUIRE(render.next(arrays));
    const BatchArrays kept = std::move(arrays);
    arrays = {};
    REQUIRE(render.next(arrays));
    CHECK(!render.next(arrays));
    CHECK(kept.pictures == 2);
    CHECK(hash_of(kept, 0, settings) == alone[0]);
    CHECK(hash_of(kept, 1, settings) == alone[1]);
    CHECK(arrays.first == 2);
    CHECK(hash_of(arrays, 0, settings) == alone[2]);
}

TEST_CASE("a batch refuses what its arrays cannot hold") {
    const auto error_of = [](const CameraBatch& batch, const RenderSettings& settings) {
        return test::thrown_error([&] { check_batch(batch, settings); });
    };
    const RenderSettings plain = batch_settings(LayersAt::Centre);
    const CameraBatch batch = three_cameras();
    CHECK(!error_of(batch, plain));
    CHECK(test::is_about(error_of({}, plain), ErrorCode::BadInput, "cameras"));
    CHECK(test::is_about(error_of({batch.cameras, {1, 2}}, plain), ErrorCode::BadInput, "seeds", "2"));
    RenderSettings settings = plain;
    settings.denoise = Denoise::Svgf;
    CHECK(!error_of(batch, settings));
    settings.samples = 0;
    CHECK(test::is_about(error_of(batch, settings), ErrorCode::BadInput, "denoise"));
    settings = plain;
    settings.aovs = kAovMotion;
    CHECK(test::is_about(error_of(batch, settings), ErrorCode::BadInput, "aov", "motion"));
    settings = plain;
    settings.irradiance = true;
    CHECK(test::is_about(error_of(batch, settings), ErrorCode::BadInput, "false_color"));
    settings = plain;
    settings.time_limit_s = 1;
    CHECK(test::is_about(error_of(batch, settings), ErrorCode::BadInput, "time_limit"));
    settings = plain;
    settings.samples = 0;
    CHECK(!error_of(batch, settings));
    settings.layers_at = LayersAt::Samples;
    CHECK(test::is_about(error_of(batch, settings), ErrorCode::BadInput, "spp"));
    CameraBatch meter = batch;
    meter.cameras[1].projection = Projection::Cosine;
    CHECK(test::is_about(error_of(meter, plain), ErrorCode::BadInput, "cameras"));
}
