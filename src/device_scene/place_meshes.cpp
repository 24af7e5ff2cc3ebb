#include "device_scene/place_meshes.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/huge_pages.h"
#include "base/limits.h"
#include "base/message_text.h"
#include "base/parallel_until.h"
#include "scene/scene_origin.h"

namespace pertev {
namespace {

/// Writes the triangles of a mesh, transformed by `world_from_local`.
void add_triangles(const Mesh& mesh, const Transform& world_from_local, uint32_t instance,
                   std::span<BvhTriangle> triangles, Sink& sink) {
    parallel_until(triangles.size(), 4096, sink, [&](uint64_t i) {
        const uint32_t* v = &mesh.indices[3 * i];
        triangles[i] = {.a = transform_point(world_from_local, mesh.positions[v[0]]),
                        .primitive = static_cast<uint32_t>(i),
                        .b = transform_point(world_from_local, mesh.positions[v[1]]),
                        .instance = instance,
                        .c = transform_point(world_from_local, mesh.positions[v[2]])};
    });
}

Error too_many_copies(const MeshPlacement& placement, std::size_t i, const Instance& instance, uint64_t limit) {
    return {ErrorCode::OverLimit, "scene", "",
            fmt::format("{}: its transform scales one direction by more than {} times another, so its mesh is copied "
                        "into world space; the {} copies have {} triangles, and the limit for this scene is {}; "
                        "scale the mesh itself, or use copies with fewer triangles",
                        numbered("instance", i, instance.name, origin_of(instance)), kMaxCondition, placement.copies,
                        placement.copied_triangles, limit)};
}

/// Selects the shared meshes that are baked all the same: those with the fewest triangles in all their instances, as
/// many as kMaxSmallCopies allows.
std::vector<bool> small_meshes(const Scene& scene, const std::vector<uint32_t>& uses) {
    std::vector<bool> is_small(uses.size());
    if (!scene.bakes_small_meshes) return is_small;
    const auto copied_triangles = [&](uint32_t mesh) {
        return uint64_t{uses[mesh]} * scene.meshes[mesh].triangle_count();
    };
    std::vector<uint32_t> order;
    for (uint32_t mesh = 0; mesh < uses.size(); ++mesh) {
        if (uses[mesh] > 1) order.push_back(mesh);
    }
    std::ranges::stable_sort(order, {}, copied_triangles);
    uint64_t sum = 0;
    for (const uint32_t mesh : order) {
        sum += copied_triangles(mesh);
        if (sum > kMaxSmallCopies) break;
        is_small[mesh] = true;
    }
    return is_small;
}

} // namespace

Vec3 world_centre(const Scene& scene) {
    const Bounds3 box = bounds_of(scene);
    return box.is_empty() ? Vec3{} : to_float(centre_of({to_double(box.lo), to_double(box.hi)}));
}

MeshPlacement place_meshes(const Scene& scene, Vec3 centre, const std::vector<bool>& apart) {
    MeshPlacement placement;
    placement.centre = centre;
    std::vector<uint32_t> uses(scene.meshes.size());
    for (const Instance& instance : scene.instances) ++uses[instance.mesh];
    uint64_t own_triangles = 0;
    for (const Mesh& mesh : scene.meshes) own_triangles += mesh.triangle_count();
    const uint64_t limit = kFreeBakedTriangles + kMaxBakedExpansion * own_triangles;
    const std::vector<bool> moves = may_move(scene), is_small = small_meshes(scene, uses);
    placement.blas_of_mesh.assign(scene.meshes.size(), kBakedMesh);
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const bool may_be_moved = moves[i] || (i < apart.size() && apart[i]);
        const bool may_be_baked = (uses[instance.mesh] == 1 || is_small[instance.mesh]) && !may_be_moved;
        const bool baked = !instance.is_hidden && (may_be_baked || is_skewed(instance.world_from_local));
        placement.is_baked.push_back(baked);
        if (baked && !may_be_baked && uses[instance.mesh] > 1) {
            ++placement.copies;
            placement.copied_triangles += scene.meshes[instance.mesh].triangle_count();
            if (placement.copied_triangles > limit) throw too_many_copies(placement, i, instance, limit);
        }
        if (!baked && placement.blas_of_mesh[instance.mesh] == kBakedMesh) {
            placement.blas_of_mesh[instance.mesh] = placement.mesh_tree_count++;
        }
    }
    return placement;
}

std::vector<BvhTriangle> baked_triangles(const Scene& scene, const MeshPlacement& placement, Sink& sink) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        if (placement.is_baked[i]) count += scene.meshes[scene.instances[i].mesh].triangle_count();
    }
    if (count > kMaxBvhTriangles) {
        throw Error(ErrorCode::OverLimit, "scene", "",
                    fmt::format("the baked meshes of the scene have {} triangles; one tree holds at most {}", count,
                                kMaxBvhTriangles));
    }
    auto triangles = array_on_huge_pages<BvhTriangle>(count);
    std::size_t first = 0;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        if (!placement.is_baked[i]) continue;
        const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
        add_triangles(mesh, moved_to(scene.instances[i].world_from_local, placement.centre), static_cast<uint32_t>(i),
                      std::span(triangles).subspan(first, mesh.triangle_count()), sink);
        first += mesh.triangle_count();
    }
    return triangles;
}

std::vector<BvhTriangle> mesh_triangles(const Mesh& mesh, Sink& sink) {
    auto triangles = array_on_huge_pages<BvhTriangle>(mesh.triangle_count());
    add_triangles(mesh, Transform{}, 0, triangles, sink);
    return triangles;
}

SceneTriangles::SceneTriangles(const Scene& scene, const MeshPlacement& placement, Sink& sink)
    : baked(baked_triangles(scene, placement, sink)), meshes(placement.mesh_tree_count) {
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) {
        const uint32_t tree = placement.blas_of_mesh[i];
        if (tree != kBakedMesh) meshes[tree] = mesh_triangles(scene.meshes[i], sink);
    }
}

uint64_t SceneTriangles::count() const {
    uint64_t count = baked.size();
    for (const auto& mesh : meshes) count += mesh.size();
    return count;
}

std::vector<PlacedBvh> placed_trees(const Scene& scene, const MeshPlacement& placement, std::span<const Bounds3> bounds,
                                    const std::shared_ptr<const MotionKeys>& motions) {
    std::vector<PlacedBvh> placed;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (placement.is_baked[i] || instance.is_hidden) continue;
        const uint32_t tree = placement.blas_of_mesh[instance.mesh];
        placed.push_back(
            {moved_to(instance.world_from_local, placement.centre), bounds[tree], tree, static_cast<uint32_t>(i)});
        if (motions == nullptr || motions->of_instance[i] == kNoMotion) continue;
        placed.back().motions = motions;
        placed.back().motion = motions->of_instance[i];
    }
    return placed;
}

} // namespace pertev
