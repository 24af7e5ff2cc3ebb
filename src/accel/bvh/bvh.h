#pragma once

// The binary bounding volume hierarchy that builders make, the cache stores and both devices traverse. A node holds
// the boxes of its two children, so that one fetch of 64 bytes decides about both. A leaf is a run of triangles whose
// last one has kLastInLeaf set.

#include <cstdint>
#include <vector>

#include "base/host_device.h"
#include "math/bounds3.h"

namespace pertev {

// A link names the next node of a traversal: an inner node's index; kLeafBit | index of a leaf's first triangle (in a
// TLAS: kLeafBit | position of the instance's record); or kNoLink for nothing, which counts as a leaf.
inline constexpr uint32_t kLeafBit = 0x80000000u;
inline constexpr uint32_t kNoLink = 0xffffffffu;
inline constexpr uint32_t kMaxBvhTriangles = kLeafBit - 1;

inline constexpr uint32_t kLastInLeaf = 1; // in BvhTriangle::flags; the other bits belong to the caller

/// A triangle of 48 bytes, loaded as three times 16.
struct alignas(16) BvhTriangle {
    Vec3 a;
    uint32_t primitive = 0; // index within its mesh
    Vec3 b;
    uint32_t instance = 0; // scene order, in a baked tree; unused in a BLAS
    Vec3 c;
    uint32_t flags = 0;
};
static_assert(sizeof(BvhTriangle) == 48);

/// Inner node of 64 bytes, loaded as four times 16. Each axis has {lower of child 0, lower of 1, upper of 0, upper of
/// 1}.
struct alignas(64) BvhNode {
    float x[4], y[4], z[4];
    uint32_t child[2];   // links
    uint32_t parent = 0; // `parent` and `split` are set by add_parent_links (parent_links.h), else 0
    uint32_t split = 0;
};
static_assert(sizeof(BvhNode) == 64);

inline void set_child(BvhNode& node, int k, const Bounds3& box, uint32_t link) {
    node.x[k] = box.lo.x, node.y[k] = box.lo.y, node.z[k] = box.lo.z;
    node.x[k + 2] = box.hi.x, node.y[k + 2] = box.hi.y, node.z[k + 2] = box.hi.z;
    node.child[k] = link;
}
inline Bounds3 child_bounds(const BvhNode& node, int k) {
    return {{node.x[k], node.y[k], node.z[k]}, {node.x[k + 2], node.y[k + 2], node.z[k + 2]}};
}

struct Bvh {
    std::vector<BvhNode> nodes; // depth first; any-hit searches usually end sooner in the first child
    std::vector<BvhTriangle> triangles;
    uint32_t root = kNoLink; // kNoLink if there is no triangle; a leaf link if there is no inner node
    Bounds3 bounds;
    int depth = 0;      // inner nodes on the longest path; at most kMaxBvhDepth
    float sah_cost = 0; // expected cost of a ray that hits the bounds, in the builder's unit
};

/// Arrays of a Bvh for traversal, as plain pointers of host or device.
struct BvhView {
    const BvhNode* nodes = nullptr;
    const BvhTriangle* triangles = nullptr;
    uint32_t root = kNoLink;
    float bounds_max_abs = 0; // largest |coordinate| of the bounds
};

inline BvhView view_of(const Bvh& bvh) {
    const bool empty = bvh.root == kNoLink;
    return {bvh.nodes.data(), bvh.triangles.data(), bvh.root, empty ? 0.0f : bvh.bounds.max_abs()};
}

} // namespace pertev
