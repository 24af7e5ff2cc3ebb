// An updated scene has the picture of a newly prepared one with the same centre, for every structure, and with lights
// infinitely far away for some of them. Only affected trees are rebuilt.

#include "render/update_scene.h"

#include <doctest/doctest.h>

#include "device_scene/scene_on_device.h"
#include "session/session.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tracer/traversal_kernels.h"

using namespace pertev;

namespace {

PreparedScene prepare_afresh(const Scene& scene, Vec3 centre) {
    Messages messages;
    PrepareOptions options;
    options.centre = centre;
    return prepare_scene(scene, options, messages);
}

void twist(Mesh& mesh) {
    for (Vec3& p : mesh.positions) p = {p.x + 0.3f * p.y * p.y, 1.1f * p.y, p.z - 0.2f * p.x};
}

/// One change of the mixed scene. Two spheres share mesh 0, which has a BLAS; mesh 3 is baked.
struct Step {
    const char* what;
    void (*change)(Scene&);
    SceneUpdate update;
};

/// The mixed scene, whose environment and directional light are left out unless `is_far`.
Scene scene_with(bool is_far) {
    Scene scene = test::make_mixed_scene();
    if (is_far) return scene;
    scene.environment.reset();
    std::erase_if(scene.lights, [](const Light& light) { return light.kind == LightKind::Directional; });
    return scene;
}

std::vector<Step> steps(bool is_far) {
    std::vector<Step> all = {
        {"an instance of a shared mesh moves",
         [](Scene& scene) { scene.instances[1].world_from_local.translation.x += 0.25f; },
         {.moved_instances = {1}, .deformed_meshes = {}, .replaced_meshes = {}}},
        {"a baked instance moves",
         [](Scene& scene) { scene.instances[4].world_from_local.translation.z += 0.25f; },
         {.moved_instances = {4}, .deformed_meshes = {}, .replaced_meshes = {}}},
        {"a shared mesh is deformed",
         [](Scene& scene) { twist(scene.meshes[0]); },
         {.moved_instances = {}, .deformed_meshes = {0}, .replaced_meshes = {}}},
        {"a baked mesh is deformed",
         [](Scene& scene) { twist(scene.meshes[3]); },
         {.moved_instances = {}, .deformed_meshes = {3}, .replaced_meshes = {}}},
        {"a shared mesh is replaced by another",
         [](Scene& scene) { scene.meshes[0] = scene.meshes[3]; },
         {.moved_instances = {}, .deformed_meshes = {}, .replaced_meshes = {0}}},
        {"a material that emits nothing changes",
         [](Scene& scene) {
             scene.materials[scene.instances[1].material].base_color = {0.1f, 0.7f, 0.3f};
         },
         {.moved_instances = {}, .deformed_meshes = {}, .replaced_meshes = {}, .materials_changed = true}},
        {"an emitter changes",
         [](Scene& scene) {
             for (Material& material : scene.materials) material.emission = 0.5f * material.emission;
         },
         {.moved_instances = {},
          .deformed_meshes = {},
          .replaced_meshes = {},
          .lights_changed = true,
          .materials_changed = true}},
        {"the environment is dimmed and turned",
         [](Scene& scene) {
             scene.environment->scale = {0.5f, 0.25f, 0.125f};
             scene.environment->rotation += 1;
         },
         {.moved_instances = {}, .deformed_meshes = {}, .replaced_meshes = {}, .environment_changed = true}},
        {"all at once",
         [](Scene& scene) {
             scene.instances[2].world_from_local.translation.y += 0.125f;
             twist(scene.meshes[0]);
             scene.meshes[3].indices.resize(scene.meshes[3].indices.size() / 2);
         },
         {.moved_instances = {2}, .deformed_meshes = {0}, .replaced_meshes = {3}}},
    };
    if (!is_far) std::erase_if(all, [](const Step& step) { return step.update.environment_changed; });
    return all;
}

} // namespace

TEST_CASE("an updated scene renders like a freshly prepared one with every structure and traversal") {
    Messages messages;
    Queue queue = test::requested_queue(), cpu = Queue::make_cpu();
    RenderSettings settings = test::layered_settings();
    const Camera camera = test::mixed_scene_camera();
    const Scene mixed = test::make_mixed_scene();
    const Vec3 centre = prepare_scene(mixed, {}, messages).centre;
    const auto fresh_hashes = [&](bool is_far) { // after each step
        std::vector<Hash128> hashes;
        Scene scene = scene_with(is_far);
        for (const Step& step : steps(is_far)) {
            step.change(scene);
            hashes.push_back(test::render_hash(render_picture(cpu, prepare_afresh(scene, centre), camera, settings)));
        }
        return hashes;
    };
    const std::vector<Hash128> fresh[] = {fresh_hashes(false), fresh_hashes(true)};
    int pictures = 0, far_structures = 0;
    for (const StructureKind structure : kValuesOf<StructureKind>) {
        for (const TraversalKind traversal : kValuesOf<TraversalKind>) {
            const Combination c = {.structure = structure, .traversal = traversal};
            if (why_no_tracer(c, queue.is_cuda())) continue;
            // Every traversal with the default's tree, and every structure, once each.
            const bool first_traversal = traversal == TraversalKind::WhileWhile || traversal == TraversalKind::Kd ||
                                         traversal == TraversalKind::Octree;
            if (structure != structure_of(kDefaultBuild) && structure != StructureKind::Reinsertion && !first_traversal)
                continue;
            CAPTURE(name_of(c));
            settings.tracers = same_for_all(c);
            // Near and far lights are balanced after each step, which takes most of the time, so three structures have
            // both.
            const bool is_far =
                first_traversal && (structure == structure_of(kDefaultBuild) || structure == StructureKind::KdMedian ||
                                    structure == StructureKind::Octree);
            far_structures += is_far;
            std::vector<Scene> scenes(1, scene_with(is_far));
            scenes.reserve(1 + steps(is_far).size());
            PreparedScene prepared = prepare_scene(scenes[0], {}, messages);
            Session session(queue, prepared, camera, settings);
            session.render(settings.samples);
            for (std::size_t k = 0; k < fresh[is_far].size(); ++k) {
                const Step step = steps(is_far)[k];
                CAPTURE(step.what);
                Scene& scene = scenes.emplace_back(scenes.back());
                step.change(scene);
                prepared = update_scene(prepared, scene, step.update, messages);
                const Hash128 before = test::render_hash(session.result());
                session.update_scene(prepared, parts_of(step.update));
                session.render(settings.samples);
                const Hash128 after = test::render_hash(session.result());
                CHECK(after == fresh[is_far][k]);
                CHECK(after != before);
                ++pictures;
            }
        }
    }
    CHECK(pictures >= 6 * 20);
    CHECK(far_structures >= (queue.is_cuda() ? 1 : 3));
}

TEST_CASE("a change rebuilds only the trees of changed meshes") {
    Messages messages;
    Scene scene = test::make_mixed_scene();
    for (const TreeBuild build : kValuesOf<TreeBuild>) {
        PrepareOptions options;
        options.tracers = default_tracers(false, build);
        const PreparedScene before = prepare_scene(scene, options, messages);
        REQUIRE(before.trees.parts.size() > 2);
        const auto same = [&](const PreparedScene& after) {
            std::vector<bool> is_same;
            for (std::size_t i = 0; i < after.trees.parts.size(); ++i) {
                is_same.push_back(after.trees.parts[i] == before.trees.parts[i]);
            }
            return is_same;
        };
        std::vector<bool> all(before.trees.parts.size(), true);
        const SceneUpdate of_materials = {.moved_instances = {},
                                          .deformed_meshes = {},
                                          .replaced_meshes = {},
                                          .lights_changed = true,
                                          .materials_changed = true};
        CHECK(parts_of(of_materials) == (kPartMaterials | kPartLights));
        CHECK(update_scene(before, scene, of_materials, messages).structures == before.structures);
        SceneUpdate update;
        update.moved_instances = {1};
        CHECK(same(update_scene(before, scene, update, messages)) == all);
        update.deformed_meshes = {0}; // the BLAS is the first or the second tree after the baked one
        std::vector<bool> found = same(update_scene(before, scene, update, messages));
        CHECK(std::ranges::count(found, false) == 1);
        CHECK(found[0]);
        update.deformed_meshes = {3};
        found = same(update_scene(before, scene, update, messages));
        CHECK(std::ranges::count(found, false) == 1);
        CHECK(!found[0]);
        // Data derived from the trees is shared, too.
        const auto nodes_of = [&](const PreparedScene& of) {
            const auto built = of.structures->get(options.tracers->bounce);
            return std::get<HostTrees>(built->trees()).blases[0].nodes;
        };
        const PreparedScene after = update_scene(before, scene, update, messages);
        CHECK(nodes_of(after) == nodes_of(before));
        CHECK(before.lights.environment != nullptr);
        CHECK(after.lights.environment == before.lights.environment);
    }
}

TEST_CASE("a change of which instances are baked prepares the scene again with the same centre") {
    Messages messages;
    Scene scene = test::make_mixed_scene();
    const PreparedScene before = prepare_scene(scene, {}, messages);
    Scene after = scene;
    after.instances[1].world_from_local = make_scale({1, 1e-5f, 1}); // too skewed for a local space
    SceneUpdate update;
    update.moved_instances = {1};
    const PreparedScene updated = update_scene(before, after, update, messages);
    CHECK(updated.is_baked != before.is_baked);
    CHECK(updated.centre == before.centre);
    Queue cpu = Queue::make_cpu();
    const Camera camera = test::mixed_scene_camera();
    CHECK(
        test::render_hash(render_picture(cpu, updated, camera, test::layered_settings())) ==
        test::render_hash(render_picture(cpu, prepare_afresh(after, before.centre), camera, test::layered_settings())));
}
