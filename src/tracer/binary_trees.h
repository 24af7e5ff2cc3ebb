#pragma once

// The binary trees of a scene, from which most structure layouts are made. Versions of a scene in which a part has
// the same triangles share that part's tree.

#include <memory>
#include <vector>

#include "accel/builders/builders.h"
#include "accel/bvh/bvh.h"
#include "device_scene/place_meshes.h"

namespace pertev {

struct BinaryTrees {
    // parts[0] is the tree over the baked instances. The rest are BLASes of the meshes that are not baked.
    std::vector<std::shared_ptr<const Bvh>> parts;
    double build_s = 0;
    std::vector<BvhBuilder> builders;   // [part] the builder that made its tree
    std::vector<float> built_cost;      // [part] sah_cost after the build, before any refit
    std::vector<std::size_t> triangles; // [part] triangle count; a triangle that several leaves hold counts once

    void add(BvhBuilder builder, Bvh bvh, std::size_t triangle_count) {
        builders.push_back(builder);
        built_cost.push_back(bvh.sah_cost);
        triangles.push_back(triangle_count);
        parts.push_back(std::make_shared<const Bvh>(std::move(bvh)));
    }
    const Bvh& baked() const { return *parts.front(); }
    uint64_t triangle_count() const;
    /// Bounds of the BLASes.
    std::vector<Bounds3> blas_bounds() const;
};

/// Builds all parts. `sink` may end it. Throws Error(OverLimit), std::bad_alloc.
BinaryTrees build_binary_trees(const SceneTriangles& triangles, BvhBuilder builder, Sink& sink = nobody());

/// Difference of a part's triangles from the previous version of the scene.
enum class PartChange {
    None,
    Deformed, // with other vertex positions
    Replaced, // by other triangles
};

/// A refitted tree is rebuilt once its SAH cost is more than this multiple of its cost after the build.
inline constexpr float kMaxRefitCost = 1.5f;

/// Builder of a part's new tree at its first deformation if its present tree cannot be refitted.
inline constexpr BvhBuilder kRefittedBuilder = BvhBuilder::Binned;

/// Returns the trees after a change. Unchanged parts are shared, and replaced parts are built by `builder`. Deformed
/// parts are refitted, or rebuilt by their own builder if refits have made them too costly. A tree that cannot be
/// refitted (why_no_refit) is replaced by one that can, because a part that deforms once usually deforms again. Only
/// `triangles` of parts that change are read. Throws as build_binary_trees.
BinaryTrees update_binary_trees(const BinaryTrees& before, BvhBuilder builder, const std::vector<PartChange>& changes,
                                const SceneTriangles& triangles);

} // namespace pertev
