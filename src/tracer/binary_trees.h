#pragma once

// A scene's binary trees: what most layouts of structures are made of. Each part's tree is shared by all versions of a
// scene in which its triangles are the same.

#include <memory>
#include <vector>

#include "accel/builders/builders.h"
#include "accel/bvh/bvh.h"
#include "device_scene/place_meshes.h"

namespace pertev {

struct BinaryTrees {
    // [0] over the baked instances; then those of the meshes that keep a tree of their own, in local space.
    std::vector<std::shared_ptr<const Bvh>> parts;
    double build_s = 0;
    std::vector<BvhBuilder> builders;   // [part] whose tree it is
    std::vector<float> built_cost;      // [part] sah_cost when it was built, before any refit
    std::vector<std::size_t> triangles; // [part] each once, though a tree may hold one in several leaves

    void add(BvhBuilder builder, Bvh bvh, std::size_t triangle_count) {
        builders.push_back(builder);
        built_cost.push_back(bvh.sah_cost);
        triangles.push_back(triangle_count);
        parts.push_back(std::make_shared<const Bvh>(std::move(bvh)));
    }
    const Bvh& baked() const { return *parts.front(); }
    uint64_t triangle_count() const;
    /// Of the meshes' own trees.
    std::vector<Bounds3> mesh_bounds() const;
};

/// Throws Error(OverLimit), std::bad_alloc.
BinaryTrees build_binary_trees(const SceneTriangles& triangles, BvhBuilder builder);

/// What has become of a part's triangles.
enum class PartChange {
    None,
    Deformed, // the same with other corners
    Replaced, // others
};

/// How much dearer a ray may become by refits before a tree is built anew.
inline constexpr float kMaxRefitCost = 1.5f;

/// Whose tree a part gets at its first deformation where its own cannot be refitted.
inline constexpr BvhBuilder kRefittedBuilder = BvhBuilder::Binned;

/// The trees after a change. Those of parts without one are shared. Replaced parts are built by `builder`. Deformed
/// ones are refitted, or built by whom they were before where refits have made them too dear; a tree that cannot be
/// refitted (why_no_refit) gives way to one that can, since what is deformed once mostly is again. Of `triangles` only
/// parts that change are looked at. Throws as build_binary_trees.
BinaryTrees update_binary_trees(const BinaryTrees& before, BvhBuilder builder, const std::vector<PartChange>& changes,
                                const SceneTriangles& triangles);

} // namespace pertev
