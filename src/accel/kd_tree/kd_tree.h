#pragma once

// The kd-tree over triangles: cells that tile the bounds, split by planes along an axis. A leaf references the
// triangles that reach into its cell, so several leaves may reference one triangle.
//
// Source of the layout: Wald, "Realtime Ray Tracing and Interactive Global Illumination", 2004, section 7.2; Pharr,
// Humphreys, "Physically Based Rendering", 4.4: 8 bytes a node, the child below the plane follows its parent.

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "math/bounds3.h"

namespace pertev {

inline constexpr int kMaxKdTreeDepth = 48;            // inner nodes on any path, and the size of a traversal stack
inline constexpr uint32_t kMaxKdTreeNodes = 1u << 30; // an index has 30 bits
inline constexpr uint32_t kMaxKdTreeTriangles = (1u << 30) - 1; // a leaf's count has 30 bits

struct alignas(8) KdTreeNode {
    uint32_t data; // inner node: bits of the plane's position; leaf: its first reference
    uint32_t link; // low 2 bits: axis, or 3 for a leaf; above: index of the child above the plane, or count of
                   // references

    HD bool is_leaf() const { return (link & 3) == 3; }
    HD int axis() const { return static_cast<int>(link & 3); }
    HD float plane() const { return float_of(data); }
    HD uint32_t above() const { return link >> 2; }
    HD uint32_t first() const { return data; }
    HD uint32_t count() const { return link >> 2; }
};
static_assert(sizeof(KdTreeNode) == 8);

inline KdTreeNode make_kd_inner(int axis, float plane, uint32_t above) {
    return {bits_of(plane), above << 2 | static_cast<uint32_t>(axis)};
}
inline KdTreeNode make_kd_leaf(uint32_t first, uint32_t count) { return {first, count << 2 | 3}; }

struct KdTree {
    std::vector<KdTreeNode> nodes;      // depth first, [0] is the root; empty if there is no triangle
    std::vector<uint32_t> references;   // positions in `triangles`, ascending within a leaf
    std::vector<BvhTriangle> triangles; // the builder's input
    Bounds3 bounds;                     // bounds of the triangles, and the root's cell
    int depth = 0;                      // inner nodes on the longest path
    float sah_cost = 0;                 // expected cost of a ray that hits the bounds, in the builder's unit
};

/// Arrays of a KdTree for traversal, as plain pointers of host or device.
struct KdTreeView {
    const KdTreeNode* nodes = nullptr; // null if there is no triangle
    const uint32_t* references = nullptr;
    const BvhTriangle* triangles = nullptr;
    Bounds3 bounds;
};

inline KdTreeView view_of(const KdTree& tree) {
    if (tree.nodes.empty()) return {};
    return {tree.nodes.data(), tree.references.data(), tree.triangles.data(), tree.bounds};
}

/// Part of a cell below a plane.
HD inline Bounds3 cell_below(Bounds3 cell, int axis, float plane) {
    (axis == 0 ? cell.hi.x : (axis == 1 ? cell.hi.y : cell.hi.z)) = plane;
    return cell;
}
HD inline Bounds3 cell_above(Bounds3 cell, int axis, float plane) {
    (axis == 0 ? cell.lo.x : (axis == 1 ? cell.lo.y : cell.lo.z)) = plane;
    return cell;
}

} // namespace pertev
