#pragma once

// The left-balanced kd-tree over points for photon maps: the k nearest within a radius, and all within a radius. Node
// i has the children 2 i + 1 and 2 i + 2, so it needs no links, and a search needs no stack.
//
// Sources: Jensen, "Realistic Image Synthesis Using Photon Mapping", 2001, section 6; Wald, "A Stack-Free Traversal
// Algorithm for Left-Balanced k-d Trees", 2022, algorithm 1. A half is skipped only if its plane is farther than the
// limit. At equal distance it is visited, so that indices break ties.

#include <cstdint>
#include <span>
#include <vector>

#include "accel/nearest_points.h"
#include "base/host_device.h"
#include "math/vec3.h"

namespace pertev {

class Sink;

inline constexpr uint32_t kMaxKdPoints = (1u << 30) - 1; // an index has 30 bits, and its double must fit an int

struct alignas(16) PointKdNode {
    Vec3 position;
    uint32_t index_and_axis; // index in the builder's input, times 4, + the split axis

    HD uint32_t index() const { return index_and_axis >> 2; }
    HD int axis() const { return static_cast<int>(index_and_axis & 3); }
};
static_assert(sizeof(PointKdNode) == 16);
inline PointKdNode kd_node(Vec3 position, uint32_t index, int axis) {
    return {position, index << 2 | static_cast<uint32_t>(axis)};
}

struct PointKdTree {
    std::vector<PointKdNode> nodes;
};

/// Arrays of a PointKdTree for searches, as plain pointers of host or device.
struct PointKdTreeView {
    const PointKdNode* nodes = nullptr;
    uint32_t count = 0;
};

inline PointKdTreeView view_of(const PointKdTree& tree) {
    return {tree.nodes.data(), static_cast<uint32_t>(tree.nodes.size())};
}

/// Builds the tree. Points are finite, |coordinate| <= kMaxCoordinate. The result does not depend on the number of
/// threads. Throws Error(OverLimit) for more than kMaxKdPoints, and Error(Interrupted) if `sink` stops it.
PointKdTree build_point_kd_tree(std::span<const Vec3> points, Sink& sink);

/// Offers `found` each point that may be within its limit, which may shrink during the search:
///   float limit() const             square of the distance beyond which points may be skipped
///   void offer(const NearPoint&)
template <class Found>
HD inline void search_points(const PointKdTreeView& tree, Vec3 at, Found& found) {
    const int count = static_cast<int>(tree.count);
    int current = 0, previous = -1; // -1 is above the root
    while (current >= 0) {
        const int parent = (current + 1) / 2 - 1;
        if (current >= count) {
            previous = current;
            current = parent;
            continue;
        }
        const PointKdNode node = tree.nodes[current];
        if (previous < current) found.offer({squared_distance(node.position, at), node.index()});
        const float from = component(at, node.axis()) - component(node.position, node.axis());
        const int near = 2 * current + (from > 0 ? 2 : 1), far = 2 * current + (from > 0 ? 1 : 2);
        int next = parent;
        if (previous < current) {
            next = near;
        } else if (previous == near && from * from <= found.limit()) {
            next = far;
        }
        previous = current;
        current = next;
    }
}

} // namespace pertev
