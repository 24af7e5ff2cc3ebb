#include "tracer/scene_structures.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/sort_until.h"
#include "scene/scene.h"
#include "tracer/deforming_tree.h"

namespace pertev {

namespace {

/// Returns the triangles in scene order, as the builder got them. Each appears once even if the tree splits it.
SceneTriangles triangles_of(const BinaryTrees& trees, Sink& sink) {
    SceneTriangles triangles;
    for (std::size_t part = 0; part < trees.parts.size(); ++part) {
        std::vector<BvhTriangle> list = trees.parts[part]->triangles;
        for (BvhTriangle& triangle : list) triangle.flags = 0;
        const auto key_of = [](const BvhTriangle& t) { return std::pair(t.instance, t.primitive); };
        sort_until(std::span(list), sink,
                   [&](const BvhTriangle& a, const BvhTriangle& b) { return key_of(a) < key_of(b); });
        const auto copies = std::ranges::unique(list, {}, key_of);
        list.erase(copies.begin(), copies.end());
        if (part == 0) {
            triangles.baked = std::move(list);
        } else {
            triangles.meshes.push_back(std::move(list));
        }
    }
    return triangles;
}

} // namespace

Tlas tlas_over(std::span<const PlacedBvh> placed, const std::map<uint32_t, Bounds3>& bounds_of_trees) {
    std::vector<PlacedBvh> now(placed.begin(), placed.end());
    for (PlacedBvh& tree : now) {
        const auto bounds = bounds_of_trees.find(tree.blas);
        if (bounds == bounds_of_trees.end()) continue;
        tree.local_bounds = bounds->second;
        if (tree.local_bounds.is_empty() || is_within_limits(tree.world_from_local, tree.local_bounds)) continue;
        throw Error(ErrorCode::OverLimit, "scene", "",
                    fmt::format("instance {} lies beyond 2^40 metres with its moved vertices; scale the scene down",
                                tree.instance));
    }
    return build_tlas(now);
}

SceneStructures::SceneStructures(BvhBuilder builder, BinaryTrees trees, Tlas tlas)
    : builder_(builder), tlas_(std::move(tlas)) {
    triangle_count_ = trees.triangle_count();
    baked_bounds_ = trees.baked().bounds;
    binary_.emplace(builder, std::move(trees));
}

std::shared_ptr<SceneStructures> SceneStructures::updated(BinaryTrees trees, Tlas tlas,
                                                          const std::vector<PartChange>& changes,
                                                          const SceneTriangles& triangles) {
    const std::lock_guard lock(mutex_);
    const auto after = std::make_shared<SceneStructures>(builder_, std::move(trees), std::move(tlas));
    for (const auto& [builder, before] : binary_) {
        if (builder == builder_) continue;
        after->binary_.emplace(builder, update_binary_trees(before, builder, changes, triangles));
    }
    for (const auto& [what, structure] : built_) {
        const auto& [kind, layout] = what;
        const BuiltStructure::Before before = {*structure, changes};
        auto& built = after->built_[what];
        if (const auto builder = builder_of(kind)) {
            built = std::make_shared<const BuiltStructure>(after->tlas_, kind, layout, after->binary_.at(*builder),
                                                           &before);
        } else {
            built = std::make_shared<const BuiltStructure>(after->tlas_, kind, triangles, &before);
        }
    }
    return after;
}

std::shared_ptr<SceneStructures> SceneStructures::fitted(Queue& queue, std::span<const DeformedMesh> meshes,
                                                         std::span<const PlacedBvh> placed) {
    const BinaryTrees before = [&] {
        const std::lock_guard lock(mutex_);
        return binary_.at(builder_);
    }();
    std::vector<PartChange> changes(before.parts.size(), PartChange::None);
    SceneTriangles triangles;
    triangles.meshes.resize(before.parts.size() - 1);
    for (const DeformedMesh& mesh : meshes) {
        changes[1 + mesh.tree] = PartChange::Deformed;
        triangles.meshes[mesh.tree] = read_triangles(queue, mesh);
    }
    BinaryTrees trees = update_binary_trees(before, builder_, changes, triangles);
    std::map<uint32_t, Bounds3> bounds;
    for (const DeformedMesh& mesh : meshes) bounds.emplace(mesh.tree, trees.parts[1 + mesh.tree]->bounds);
    Tlas tlas = tlas_over(placed, bounds);
    return updated(std::move(trees), std::move(tlas), changes, triangles);
}

const BinaryTrees& SceneStructures::binary_trees(BvhBuilder builder, Sink& sink) {
    const auto at = binary_.find(builder);
    if (at != binary_.end()) return at->second;
    const SceneTriangles triangles = triangles_of(binary_.at(builder_), sink);
    return binary_.emplace(builder, build_binary_trees(triangles, builder, sink)).first->second;
}

std::shared_ptr<const BuiltStructure> SceneStructures::get(const Combination& combination, Sink& sink) {
    const std::lock_guard lock(mutex_);
    const StructureKind kind = combination.structure;
    const TreeLayout layout = layout_of(combination);
    const auto at = built_.find({kind, layout});
    if (at != built_.end()) return at->second;
    std::shared_ptr<const BuiltStructure> built;
    if (const auto builder = builder_of(kind)) {
        built =
            std::make_shared<const BuiltStructure>(tlas_, kind, layout, binary_trees(*builder, sink), nullptr, sink);
    } else {
        const SceneTriangles triangles = triangles_of(binary_.at(builder_), sink);
        built = std::make_shared<const BuiltStructure>(tlas_, kind, triangles, nullptr, sink);
    }
    return built_.emplace(std::pair(kind, layout), built).first->second;
}

} // namespace pertev
