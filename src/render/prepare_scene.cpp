#include "render/prepare_scene.h"

#include <span>

#include <fmt/format.h>

#include "accel/bvh/bvh_cache.h"
#include "base/error.h"
#include "base/parallel_for.h"
#include "base/stopwatch.h"
#include "image/srgb_table.h"

namespace pertev {
namespace {

constexpr float kMaxCondition = 4096; // 2^12
constexpr uint32_t kBaked = 0xffffffffu;

struct Placement {
    std::vector<uint32_t> uses;        // of each mesh
    std::vector<bool> is_baked;        // of each instance
    std::vector<uint32_t> bvh_of_mesh; // index into mesh_bvhs, or kBaked where no instance needs it
    uint32_t mesh_bvh_count = 0;
};

Placement place_instances(const Scene& scene) {
    Placement placement;
    placement.uses.resize(scene.meshes.size());
    for (const Instance& instance : scene.instances) ++placement.uses[instance.mesh];
    placement.bvh_of_mesh.assign(scene.meshes.size(), kBaked);
    for (const Instance& instance : scene.instances) {
        const bool baked =
            placement.uses[instance.mesh] == 1 || !(condition_number(instance.world_from_local) <= kMaxCondition);
        placement.is_baked.push_back(baked);
        if (!baked && placement.bvh_of_mesh[instance.mesh] == kBaked) {
            placement.bvh_of_mesh[instance.mesh] = placement.mesh_bvh_count++;
        }
    }
    return placement;
}

/// Triangles of a mesh, moved by `world_from_local`.
void add_triangles(const Mesh& mesh, const Transform& world_from_local, uint32_t instance,
                   std::span<BvhTriangle> triangles) {
    parallel_for(triangles.size(), 4096, [&](uint64_t i) {
        const uint32_t* v = &mesh.indices[3 * i];
        triangles[i] = {.a = transform_point(world_from_local, mesh.positions[v[0]]),
                        .primitive = static_cast<uint32_t>(i),
                        .b = transform_point(world_from_local, mesh.positions[v[1]]),
                        .instance = instance,
                        .c = transform_point(world_from_local, mesh.positions[v[2]])};
    });
}

std::vector<BvhTriangle> baked_triangles(const Scene& scene, const Placement& placement) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        if (placement.is_baked[i]) count += scene.meshes[scene.instances[i].mesh].triangle_count();
    }
    if (count > kMaxBvhTriangles) {
        throw Error(ErrorCode::OverLimit, fmt::format("the scene has {} triangles outside shared meshes; at most {} "
                                                      "fit one tree",
                                                      count, kMaxBvhTriangles));
    }
    std::vector<BvhTriangle> triangles(count);
    std::size_t first = 0;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        if (!placement.is_baked[i]) continue;
        const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
        add_triangles(mesh, scene.instances[i].world_from_local, static_cast<uint32_t>(i),
                      std::span(triangles).subspan(first, mesh.triangle_count()));
        first += mesh.triangle_count();
    }
    return triangles;
}

} // namespace

PreparedScene prepare_scene(const Scene& scene, const PrepareOptions& options, Messages& messages) {
    const Stopwatch watch;
    PreparedScene prepared;
    prepared.scene = &scene;
    const Placement placement = place_instances(scene);

    prepared.baked = load_or_build_bvh(baked_triangles(scene, placement), options.bvh, options.bvh_cache, messages);
    prepared.mesh_bvhs.resize(placement.mesh_bvh_count);
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        if (placement.bvh_of_mesh[i] == kBaked) continue;
        std::vector<BvhTriangle> triangles(scene.meshes[i].triangle_count());
        add_triangles(scene.meshes[i], Transform{}, 0, triangles);
        prepared.mesh_bvhs[placement.bvh_of_mesh[i]] =
            load_or_build_bvh(triangles, options.bvh, options.bvh_cache, messages);
    }
    std::vector<PlacedBvh> placed;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        if (placement.is_baked[i]) continue;
        const uint32_t mesh_bvh = placement.bvh_of_mesh[scene.instances[i].mesh];
        placed.push_back({scene.instances[i].world_from_local, prepared.mesh_bvhs[mesh_bvh].bounds, mesh_bvh,
                          static_cast<uint32_t>(i)});
    }
    prepared.top_level = build_top_level_bvh(placed);
    prepared.triangles = prepared.baked.triangles.size();
    for (const Bvh& bvh : prepared.mesh_bvhs) prepared.triangles += bvh.triangles.size();
    prepared.build_seconds = watch.seconds();

    prepared.lights = build_light_set(scene, srgb_decode_table().data(), messages);
    return prepared;
}

} // namespace pertev
