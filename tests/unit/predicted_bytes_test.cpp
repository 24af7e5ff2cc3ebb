// Predicted memory of a scene on the device.

#include <doctest/doctest.h>

#include <sys/resource.h>

#include <algorithm>

#include "device_scene/scene_on_device.h"
#include "integrators/path/path_integrator.h"
#include "settings/value_names.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tracer/scene_tracer.h"

using namespace pertev;

namespace {

Mesh make_triangle() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.indices = {0, 1, 2};
    return mesh;
}

/// Returns the predicted bytes of the scene, which must equal the actual ones, and those with its trees, which take no
/// memory if the device is the host.
std::size_t bytes_of(const Scene& scene) {
    Messages messages;
    const PreparedScene prepared = prepare_scene(scene, {}, messages);
    Queue queue = test::requested_queue();
    const std::size_t predicted = predicted_bytes(prepared, queue.is_cuda());
    const SceneOnDevice on_device(queue, prepared);
    CHECK(queue.allocated_bytes() == predicted);
    const TracerChoice choice = default_tracers(queue.is_cuda());
    Queue counting = Queue::make_dry_run(queue.is_cuda());
    const SceneTracer tracer(queue, *prepared.structures, choice), counted(counting, *prepared.structures, choice);
    CHECK(queue.allocated_bytes() == predicted + counting.allocated_bytes());
    return predicted;
}

} // namespace

TEST_CASE("memory of a scene equals its prediction") {
    CHECK(bytes_of(test::make_mixed_scene()) > 50'000);
    CHECK(bytes_of(test::make_furnace_scene(0.5f)) > 5'000);
}

TEST_CASE("each light of a scene counts in its predicted memory") {
    constexpr std::size_t kCount = 64;
    Scene scene;
    scene.meshes.push_back(make_triangle());
    scene.materials.resize(2);
    scene.materials[1].emission = {1, 1, 1};
    for (std::size_t i = 0; i < kCount; ++i) scene.instances.push_back({"", 0, 0, {}});
    const std::size_t dark = bytes_of(scene);

    Scene with_emitters = scene;
    with_emitters.lights.resize(kCount);
    // This is a lower bound, because the table that selects lights also grows by a start and a slot of 4 bytes each.
    CHECK(bytes_of(with_emitters) >= dark + kCount * (sizeof(PunctualLight) + 8));

    Scene glowing = scene;
    for (Instance& instance : glowing.instances) instance.material = 1;
    CHECK(bytes_of(glowing) >= dark + kCount * (sizeof(Emitter) + sizeof(EmissiveTriangle) + 16));
}

TEST_CASE("queues of paths use nearly all of their memory limit, whatever else a path stores") {
    constexpr std::size_t kMaxBytes = PathIntegrator::kMaxQueueBytes;
    for (uint32_t bits = 0; bits < 16; ++bits) {
        CAPTURE(bits);
        const PathParts parts = {.has_times = (bits & 1) != 0,
                                 .has_layers = (bits & 2) != 0,
                                 .splits_light = (bits & 4) != 0,
                                 .records_bounce = (bits & 8) != 0};
        for (const bool on_cuda : {false, true}) {
            const auto bytes = [&](uint32_t width, uint32_t height, uint32_t batch) {
                Queue queue = Queue::make_dry_run(on_cuda);
                PathRequest request;
                if (parts.has_layers) request.layers = std::make_shared<const LightPathLayers>();
                PathIntegrator(queue, request, false, batch)
                    .reserve({.width = width,
                              .height = height,
                              .has_times = parts.has_times,
                              .splits_light = parts.splits_light,
                              .records_bounce = parts.records_bounce});
                return queue.peak_bytes();
            };
            CHECK(bytes(1 << 16, 1 << 16, 1u << 31) <= kMaxBytes);
            CHECK(bytes(1 << 16, 1 << 16, 1u << 31) >= kMaxBytes - 100'000);
            CHECK(bytes(3840, 2160, RenderSettings{}.batch) <= kMaxBytes);
            CHECK(bytes(3840, 2160, RenderSettings{}.batch) >= kMaxBytes - 3'000'000);
            CHECK(bytes(64, 1, 1000) == bytes(1000, 1, 64)); // the smaller of both counts
            CHECK(bytes(64, 1, 1000) < 64 * 400);
        }
    }
}

TEST_CASE("every integrator predicts its memory for an impossibly large picture without allocating it") {
    const WorkSize huge = {.width = 1 << 16, .height = 1 << 15, .samples = 4, .triangles = 1'000'000};
    const auto peak_kib = [] {
        rusage usage = {};
        ::getrusage(RUSAGE_SELF, &usage);
        return usage.ru_maxrss;
    };
    const long before = peak_kib();
    for (const IntegratorDescriptor& integrator : integrators()) {
        CAPTURE(integrator.name);
        CHECK(&describe(integrator.value) == &integrator);
        CHECK(value_named<IntegratorKind>(integrator.name) == integrator.value);
        RenderSettings settings;
        settings.integrator = integrator.value;
        settings.path.max_depth = std::min(settings.path.max_depth, integrator.max_depth);
        CHECK(predicted_bytes(settings, huge, true) > 100'000'000);
        WorkSize small = huge;
        small.width = small.height = 8;
        CHECK(predicted_bytes(settings, small, true) < predicted_bytes(settings, huge, true));
        // A light tree needs the normal of a path's last vertex.
        const std::size_t by_power = predicted_bytes(settings, small, true);
        settings.path.light_choice = LightSelection::Tree;
        CHECK(predicted_bytes(settings, small, true) == by_power);
        small.tree_lights = 1000;
        CHECK((predicted_bytes(settings, small, true) > by_power) == integrator.selects_lights);
    }
    CHECK(peak_kib() - before < 50'000);
}
