#pragma once

// A scene of instances that are difficult for traversals: rotated, mirrored, flattened, far from their local origins,
// some of them identical, with or without a baked mesh. It has the hits of brute force.

#include <vector>

#include "accel/bvh/tlas.h"
#include "tests/support/check_traversal.h"
#include "trace/scene_trees.h"

namespace pertev::test {

struct InstancedScene {
    std::vector<std::vector<BvhTriangle>> meshes; // [InstanceRecord::blas]
    std::vector<Bvh> trees;                       // the trees of the meshes
    std::vector<BvhTriangle> baked;
    Bvh baked_tree;
    std::vector<PlacedBvh> placed;
    Tlas top;
    std::vector<Ray> rays;

    /// Makes a scene over views of the meshes' trees of any kind, which must outlive it. `baked` may be empty.
    template <class Tree>
    SceneTrees<Tree> scene(const std::vector<Tree>& views, const Tree& baked_view = {}) const {
        return {baked_view, top.nodes.data(), top.instances.data(), views.data(), top.root, top.reach, top.growth};
    }

    std::vector<Hit> hits_by_brute_force(bool with_baked) const; // AcceptSome
};

InstancedScene make_instanced_scene(uint32_t ray_count);

} // namespace pertev::test
