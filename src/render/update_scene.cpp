#include "render/update_scene.h"

#include <algorithm>
#include <utility>

#include "base/stopwatch.h"
#include "device_scene/place_meshes.h"
#include "device_scene/scene_on_device.h"
#include "image/srgb_table.h"
#include "render/balance_lights.h"

namespace pertev {
namespace {

/// Returns the change of each part of the trees.
std::vector<PartChange> changes_of(const Scene& scene, const MeshPlacement& placement, const SceneUpdate& update) {
    std::vector<PartChange> changes(1 + placement.mesh_tree_count, PartChange::None);
    const auto raise = [&](std::size_t part, PartChange change) { changes[part] = std::max(changes[part], change); };
    const auto mesh_changes = [&](const std::vector<uint32_t>& meshes, PartChange change) {
        for (const uint32_t mesh : meshes) {
            if (placement.blas_of_mesh[mesh] != kBakedMesh) raise(1 + placement.blas_of_mesh[mesh], change);
            for (std::size_t i = 0; i < scene.instances.size(); ++i) {
                if (placement.is_baked[i] && scene.instances[i].mesh == mesh) raise(0, change);
            }
        }
    };
    mesh_changes(update.deformed_meshes, PartChange::Deformed);
    mesh_changes(update.replaced_meshes, PartChange::Replaced);
    for (const uint32_t instance : update.moved_instances) {
        if (placement.is_baked[instance]) raise(0, PartChange::Deformed);
    }
    return changes;
}

/// Returns the triangles of the parts that change; other parts are empty.
SceneTriangles changed_triangles(const Scene& scene, const MeshPlacement& placement,
                                 const std::vector<PartChange>& changes) {
    SceneTriangles triangles;
    triangles.meshes.resize(placement.mesh_tree_count);
    if (changes[0] != PartChange::None) triangles.baked = baked_triangles(scene, placement);
    for (std::size_t mesh = 0; mesh < scene.meshes.size(); ++mesh) {
        const uint32_t tree = placement.blas_of_mesh[mesh];
        if (tree == kBakedMesh || changes[1 + tree] == PartChange::None) continue;
        triangles.meshes[tree] = mesh_triangles(scene.meshes[mesh]);
    }
    return triangles;
}

void update_lights(const PreparedScene& before, const Scene& scene, const SceneUpdate& update, Sink& sink,
                   PreparedScene& after) {
    const auto environment = update.environment_changed ? nullptr : before.lights.environment;
    after.lights = build_light_set(scene, srgb_decode_table().data(), sink, after.centre, environment);
    balance_lights(after, srgb_decode_table().data());
}

} // namespace

PreparedScene update_scene(const PreparedScene& before, const Scene& scene, const SceneUpdate& update, Sink& sink,
                           std::shared_ptr<const MotionKeys> motions) {
    const Stopwatch watch;
    if (update.keeps_surfaces() && motions == before.motions) {
        PreparedScene after = before;
        after.scene = &scene;
        if (update.lights_changed || update.environment_changed) update_lights(before, scene, update, sink, after);
        after.build_seconds = watch.seconds();
        return after;
    }
    const MeshPlacement placement = place_meshes(scene, before.centre, before.apart);
    if (placement.is_baked != before.is_baked || 1 + placement.mesh_tree_count != before.trees.parts.size()) {
        PrepareOptions options;
        options.centre = before.centre;
        options.builder = before.structures->builder();
        options.motions = std::move(motions);
        options.apart = before.apart;
        return prepare_scene(scene, options, sink);
    }
    PreparedScene after = before;
    after.scene = &scene;
    const std::vector<PartChange> changes = changes_of(scene, placement, update);
    const SceneTriangles triangles = changed_triangles(scene, placement, changes);
    after.trees = update_binary_trees(before.trees, before.structures->builder(), changes, triangles);
    after.placed = placed_trees(scene, placement, after.trees.blas_bounds(), motions);
    after.motions = std::move(motions);
    after.tlas = build_tlas(after.placed);
    after.structures = before.structures->updated(after.trees, after.tlas, changes, triangles);
    after.triangles = after.trees.triangle_count();
    after.build_seconds = watch.seconds();
    update_lights(before, scene, update, sink, after);
    return after;
}

bool changes_prepared(const SceneUpdate& update) {
    SceneUpdate rest = update;
    rest.poses_changed = false;
    return !rest.is_empty();
}

uint32_t parts_of(const SceneUpdate& update) {
    uint32_t parts = update.lights_changed ? kPartLights : 0u;
    if (update.environment_changed) parts |= kPartLights | kPartEnvironment;
    if (update.materials_changed) parts |= kPartMaterials;
    if (update.poses_changed) parts |= kPartPoses;
    if (!update.keeps_surfaces()) parts |= kPartLights | kPartTrees | kPartInstances;
    if (!update.deformed_meshes.empty() || !update.replaced_meshes.empty()) parts |= kPartGeometry;
    return parts;
}

} // namespace pertev
