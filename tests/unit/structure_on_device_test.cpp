// A structure's copy on a device is updated after changes of the scene. Unchanged parts are neither copied nor
// allocated again. The test makes the copy on the CPU, too, where pictures do not need it.

#include "tracer/structure_on_device.h"

#include <memory>

#include <doctest/doctest.h>

#include "lab/trace_rays.h"
#include "render/update_scene.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/random.h"
#include "tests/support/render_scenes.h"

using namespace pertev;

namespace {

/// The mixed scene with a shared mesh of 5120 triangles, mesh 0 of instances 1 to 3.
Scene scene_with_large_mesh(int subdivisions = 4) {
    Scene scene = test::make_mixed_scene();
    const test::TriangleMesh sphere = test::make_sphere(subdivisions, {0, 0, 0}, 1.0f);
    scene.meshes[0].positions = sphere.positions;
    scene.meshes[0].indices = sphere.indices;
    scene.meshes[0].normals = sphere.positions;
    return scene;
}

std::vector<Ray> rays_through_the_room() {
    std::vector<Ray> rays;
    test::Random random(5);
    for (int i = 0; i < 500; ++i) {
        const Vec3 from = {8 * random.unit() - 4, 4 * random.unit(), 8 * random.unit() - 4};
        const Vec3 to = {6 * random.unit() - 3, 2 * random.unit(), 6 * random.unit() - 3};
        rays.push_back({from, 0, normalize(to - from), kInfinity});
    }
    return rays;
}

std::vector<RayHit> hits_of(Queue& queue, const Combination& c, std::shared_ptr<const StructureOnDevice> structure,
                            const std::vector<Ray>& rays) {
    const Tracer tracer(queue, c, std::move(structure));
    std::vector<RayHit> hits(rays.size());
    make_ray_tracer(queue, tracer)(rays, hits);
    return hits;
}

struct Change {
    const char* what;
    void (*change)(Scene&);
    SceneUpdate update;
    double max_copied; // largest fraction of the structure's bytes that is copied
    bool takes_memory;
};

} // namespace

TEST_CASE("a structure on a device updates only what has changed and gives the hits of a fresh one") {
    Messages messages;
    Queue queue = test::requested_queue();
    const std::vector<Ray> rays = rays_through_the_room();
    const Change changes[] = {
        {"nothing moves", [](Scene&) {}, {}, 0.02, false},
        {"an instance moves",
         [](Scene& scene) { scene.instances[1].world_from_local.translation.x += 0.25f; },
         {.moved_instances = {1}, .deformed_meshes = {}, .replaced_meshes = {}},
         0.02,
         false},
        {"another mesh is deformed",
         [](Scene& scene) { scene.meshes[1].positions[0].y += 0.5f; },
         {.moved_instances = {}, .deformed_meshes = {1}, .replaced_meshes = {}},
         0.02,
         false},
        {"a larger mesh stands in its place",
         [](Scene& scene) { scene.meshes[0] = scene_with_large_mesh(5).meshes[0]; },
         {.moved_instances = {}, .deformed_meshes = {}, .replaced_meshes = {0}},
         1,
         true},
        {"a smaller mesh stands in its place",
         [](Scene& scene) { scene.meshes[0] = scene_with_large_mesh(3).meshes[0]; },
         {.moved_instances = {}, .deformed_meshes = {}, .replaced_meshes = {0}},
         1,
         false},
    };
    for (const TraversalKind traversal : {TraversalKind::WhileWhile, TraversalKind::SkipLinks, TraversalKind::Wide8,
                                          TraversalKind::Wide8Simd, TraversalKind::Compressed, TraversalKind::Kd}) {
        Combination c = {.structure = StructureKind::Binned, .traversal = traversal};
        if (traversal == TraversalKind::Kd) c.structure = StructureKind::KdMedian;
        if (why_no_tracer(c, queue.is_cuda())) continue;
        CAPTURE(name_of(c));
        std::vector<Scene> scenes(1, scene_with_large_mesh());
        scenes.reserve(1 + std::size(changes));
        PrepareOptions options;
        options.builder = BvhBuilder::Binned;
        PreparedScene prepared = prepare_scene(scenes[0], options, messages);
        const auto placed = std::make_shared<StructureOnDevice>(queue, prepared.structures->get(c), true);
        for (const Change& step : changes) {
            CAPTURE(step.what);
            step.change(scenes.emplace_back(scenes.back()));
            prepared = update_scene(prepared, scenes.back(), step.update, messages);
            const uint64_t uploaded = queue.uploaded_bytes(), allocations = queue.allocation_count();
            const AnyTrees* trees = &placed->trees();
            placed->update(prepared.structures->get(c));
            const uint64_t copied = queue.uploaded_bytes() - uploaded;
            CHECK(copied <= step.max_copied * static_cast<double>(placed->built().device_bytes()));
            CHECK((queue.allocation_count() > allocations) == step.takes_memory);
            if (step.max_copied < 1) CHECK(copied < 65536);
            CHECK(&placed->trees() == trees);
            const auto fresh = std::make_shared<const StructureOnDevice>(queue, prepared.structures->get(c));
            const std::vector<RayHit> hits = hits_of(queue, c, placed, rays);
            CHECK(hits == hits_of(queue, c, fresh, rays));
            CHECK(std::ranges::count_if(hits, [](const RayHit& hit) { return hit.instance == 1; }) > 5);
            const uint64_t before_again = queue.uploaded_bytes();
            placed->update(prepared.structures->get(c));
            CHECK(queue.uploaded_bytes() == before_again);
        }
    }
}
