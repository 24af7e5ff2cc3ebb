#include "tracer/scene_tracer.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"

namespace pertev {
namespace {

/// Returns the structure for a combination. Throws Error(OverLimit).
std::shared_ptr<const BuiltStructure> structure_for(const Combination& c, SceneStructures& structures) {
    const uint64_t triangles = structures.triangle_count();
    if (c.traversal != TraversalKind::BruteForce || triangles <= kMaxBruteForceTriangles) return structures.get(c);
    throw Error(ErrorCode::OverLimit, "traversal", std::string(name_of(c.traversal)),
                fmt::format("each ray would test all {} triangles of the scene; the limit for pictures is {}",
                            triangles, kMaxBruteForceTriangles));
}

} // namespace

SceneTracer::SceneTracer(Queue& queue, SceneStructures& structures, const TracerChoice& choice)
    : queue_(queue), choice_(choice), scene_on_device_(queue, 1, "scene"), bounds_(structures.bounds()),
      baked_bounds_(structures.baked_bounds()) {
    check_choice(choice, queue.is_cuda());
    std::map<std::shared_ptr<const BuiltStructure>, std::shared_ptr<StructureOnDevice>> placed;
    for (const RayKind kind : kValuesOf<RayKind>) {
        const auto built = structure_for(choice[kind], structures);
        auto& structure = placed[built];
        if (structure == nullptr) structure = std::make_shared<StructureOnDevice>(queue, built);
        structures_.push_back(structure);
        tracers_.push_back(std::make_unique<Tracer>(queue, choice[kind], structure));
    }
    if (can_traverse_on_host(choice, queue.is_cuda())) {
        host_trees_ = &std::get<HostTrees>(tracers_.front()->structure().trees());
    }
}

void SceneTracer::set_structures(SceneStructures& structures) {
    bounds_ = structures.bounds();
    baked_bounds_ = structures.baked_bounds();
    for (const RayKind kind : kValuesOf<RayKind>) {
        structures_[static_cast<std::size_t>(kind)]->update(structure_for(choice_[kind], structures));
    }
}

bool SceneTracer::can_deform() const {
    return std::ranges::all_of(kValuesOf<RayKind>, [&](RayKind kind) {
        return pertev::can_deform(layout_of(choice_[kind]), queue_.is_cuda());
    });
}

void SceneTracer::deform(std::span<const DeformedMesh> meshes, std::span<const PlacedBvh> placed) {
    const std::set<std::shared_ptr<StructureOnDevice>> all(structures_.begin(), structures_.end());
    std::map<uint32_t, Bounds3> bounds_of_trees;
    for (const auto& structure : all) {
        const std::vector<Bounds3> bounds = structure->deform(meshes);
        for (std::size_t i = 0; i < meshes.size(); ++i) bounds_of_trees[meshes[i].tree] = bounds[i];
    }
    const Tlas tlas = tlas_over(placed, bounds_of_trees);
    for (const auto& structure : all) structure->place(meshes, tlas);
    bounds_ = baked_bounds_;
    bounds_.extend(tlas.bounds);
}

void SceneTracer::set_surfaces(const SceneView& scene) {
    scene_ = scene;
    scene_on_device_.upload(std::span(&scene, 1));
}

TraceQuery SceneTracer::query_of(RayKind kind, const RayQueueView& rays) const {
    TraceQuery query = {.rays = rays};
    const bool hides_backs = kind == RayKind::Camera && scene_.any_hidden_back != 0;
    if (hides_backs) query.passes |= kPassesCulledBacks;
    if (rays.passes_thin_walls) query.passes |= kPassesThinWalls;
    if (scene_.any_alpha != 0 || query.passes != 0) {
        query.scene = scene_on_device_.data();
        query.passing = scene_.passing;
        if (!hides_backs) query.micromaps = scene_.micromaps;
    }
    if (scene_.motions.is_there()) query.moving = scene_on_device_.data();
    return query;
}

void SceneTracer::find_hits(RayKind kind, const RayQueueView& rays, WorkCount count, const HitQueueView& hits,
                            uint32_t* pool) {
    timed(kind, [&] { tracer(kind).find_hits(query_of(kind, rays), count, hits, pool); });
}

void SceneTracer::find_occlusions(const RayQueueView& rays, WorkCount count, const HitQueueView& hits, uint32_t* pool) {
    constexpr RayKind kind = RayKind::Shadow;
    timed(kind, [&] { tracer(kind).find_occlusions(query_of(kind, rays), count, hits, pool); });
}

} // namespace pertev
