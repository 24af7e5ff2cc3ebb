#pragma once

// Splits a cell of a kd-tree by the surface area heuristic, at the best of all planes at which the number of
// triangles on a side changes.
//
// Source: Wald, Havran, "On building fast kd-trees for Ray Tracing, and on doing that in O(N log N)", IEEE RT 2006,
// sections 3 and 4.3: planes come from triangles clipped to the cell (perfect splits); triangles in the plane go to
// the cheaper side; a split that leaves a side empty gets a bonus; events are sorted once and stay sorted on the way
// down, except those of triangles on both sides, which are recomputed and merged.

#include <cstdint>
#include <optional>
#include <vector>

#include "accel/kd_tree/build_kd_tree.h"
#include "accel/kd_tree/kd_subtree.h"

namespace pertev {

class SahKdSplitter {
public:
    // NOLINTNEXTLINE(bugprone-reserved-identifier,readability-identifier-naming): the compiler generates the name
    struct Node : KdBuildNode {
        std::vector<uint32_t> triangles; // [count] positions in the input
        std::vector<uint64_t> events[3]; // ends of triangles along each axis, sorted; see make_event
    };

    SahKdSplitter(const std::vector<BvhTriangle>& triangles, const KdTreeSettings& settings, float max_abs);

    /// Makes the root with all triangles. The caller sets cell, levels and budget.
    Node make_root() const;
    std::optional<KdPlane> split(const Node& node, Node& below, Node& above) const;
    static std::vector<uint32_t> triangles_of(const Node& node);

private:
    struct Choice;
    Choice find_cheapest(const Node& node, int axis) const;

    const std::vector<BvhTriangle>& triangles_;
    const KdTreeSettings& settings_;
    float max_abs_;
};

} // namespace pertev
