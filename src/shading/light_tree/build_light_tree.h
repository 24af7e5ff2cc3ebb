#pragma once

// Builds the tree of light_tree.h: one over all lights (build_subtree.h), in which one light stands for each instance
// of a mesh whose lights have a subtree. Lights that move get a new tree, since one that is refitted would depend on
// where they were before, and a picture may not.

#include <atomic>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "base/raw_vector.h"
#include "math/bounds3.h"
#include "math/transform.h"
#include "shading/light_tree/build_subtree.h"
#include "shading/light_tree/light_tree_view.h"

namespace pertev {

/// An instance of a mesh whose lights have a shared subtree.
struct SharedTreeInstance {
    uint32_t subtree = 0;       // index into TreeLights::shared
    uint32_t first_light = 0;   // number of the light of its first triangle
    Transform world_from_local; // translated world, a similarity (is_similarity)
    Bounds3 bounds;             // box of its lights, metres
    double power = 0;           // sum of its lights' powers, as TreeLight has them
};

struct TreeLights {
    std::vector<TreeLight> lights;                   // by the numbers of lights; those of instances have no power
    std::vector<std::vector<TreeLight>> shared = {}; // the triangles of a mesh, at least two of which give light
    std::vector<SharedTreeInstance> instances = {};

    /// Lights that a tree has leaves for.
    uint32_t count() const;
};

/// Returns whether the transform keeps all angles, to 1e-4.
bool is_similarity(const Transform& transform);

struct LightTreeData {
    RawVector<LightTreeNode> nodes;      // empty: no light has power
    std::vector<uint32_t> leaf_of_light; // [lights]
    std::vector<LightTreeInstance> instances;
    std::vector<uint32_t> leaf_of_triangle;
    uint32_t light_count = 0;

    LightTreeView view() const {
        return {nodes.data(), leaf_of_light.data(), instances.data(), leaf_of_triangle.data(), light_count};
    }
};

LightTreeData build_light_tree(TreeLights lights);

/// The lights of a tree, and the tree, which the first request builds, from any thread.
class RequestedLightTree {
public:
    explicit RequestedLightTree(TreeLights lights);

    /// Returns the tree.
    const LightTreeData& get() const;
    /// Returns LightTreeData::light_count without the tree.
    uint32_t light_count() const { return light_count_; }
    bool is_built() const { return is_built_; }

private:
    mutable TreeLights lights_; // empty after the first request
    mutable LightTreeData data_;
    mutable std::once_flag once_;
    mutable std::atomic<bool> is_built_ = false;
    uint32_t light_count_;
};

} // namespace pertev
