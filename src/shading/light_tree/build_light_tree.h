#pragma once

// Builds the tree of light_tree.h, top down, by Conty Estevez and Kulla's surface area orientation heuristic over bins.
// The tree does not depend on the number of threads. Lights that move get a new tree: one that is refitted would depend
// on where they were before, and a picture may not.

#include <atomic>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "base/raw_vector.h"
#include "math/bounds3.h"
#include "shading/light_tree/light_tree_view.h"

namespace pertev {

/// A light to be put into a tree.
struct TreeLight {
    Bounds3 bounds;           // metres
    Vec3 axis;                // unit normal, or the axis of a spot; any if light leaves in all directions
    float emission_angle = 0; // within which light leaves from the axis, radians; pi: in all directions
    bool has_two_sides = false;
    double power = 0; // pi times its largest intensity, which is the power of a diffuse face, W; 0: it is left out
};

struct LightTreeData {
    RawVector<LightTreeNode> nodes;      // empty: no light has power
    std::vector<uint32_t> leaf_of_light; // [lights]

    uint32_t light_count() const { return static_cast<uint32_t>(nodes.size() / 2); }
    LightTreeView view() const { return {nodes.data(), leaf_of_light.data(), light_count()}; }
};

LightTreeData build_light_tree(std::span<const TreeLight> lights);

/// The lights of a tree, and the tree, which the first request builds, from any thread.
class RequestedLightTree {
public:
    explicit RequestedLightTree(std::vector<TreeLight> lights);

    /// Returns the tree.
    const LightTreeData& get() const;
    /// Returns LightTreeData::light_count() without the tree.
    uint32_t light_count() const { return light_count_; }
    bool is_built() const { return is_built_; }

private:
    mutable std::vector<TreeLight> lights_; // empty after the first request
    mutable LightTreeData data_;
    mutable std::once_flag once_;
    mutable std::atomic<bool> is_built_ = false;
    uint32_t light_count_;
};

} // namespace pertev
