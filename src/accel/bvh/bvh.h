#pragma once

// The binary bounding volume hierarchy: what builders make, the cache stores and both devices walk. A node holds the
// boxes of its two children, so that one fetch of 64 bytes decides both. A leaf is a run of triangles; the last one of
// a run carries kLastInLeaf.

#include <cstdint>
#include <vector>

#include "base/host_device.h"
#include "math/bounds3.h"

namespace pertev {

// A link names what a walk goes to next: an inner node's index, or kLeafBit | index of a leaf's first triangle (of a
// top-level tree: kLeafBit | position of the instance's record), or kNoLink (nothing; it counts as a leaf).
inline constexpr uint32_t kLeafBit = 0x80000000u;
inline constexpr uint32_t kNoLink = 0xffffffffu;
inline constexpr uint32_t kMaxBvhTriangles = kLeafBit - 1;

inline constexpr uint32_t kLastInLeaf = 1; // BvhTriangle::flags; the other bits are the caller's

/// One triangle, 48 bytes: three loads of 16.
struct alignas(16) BvhTriangle {
    Vec3 a;
    uint32_t primitive = 0; // index within its mesh
    Vec3 b;
    uint32_t instance = 0; // scene order, in a baked tree; unused in a mesh's own
    Vec3 c;
    uint32_t flags = 0;
};
static_assert(sizeof(BvhTriangle) == 48);

/// Inner node, 64 bytes: four loads of 16. Along each axis {lower of child 0, lower of 1, upper of 0, upper of 1}.
struct alignas(64) BvhNode {
    float x[4], y[4], z[4];
    uint32_t child[2];   // links
    uint32_t parent = 0; // this and `split` are what add_parent_links (parent_links.h) makes of them; else 0
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
    std::vector<BvhNode> nodes; // depth first; of two children, the first is where any-hit searches end sooner
    std::vector<BvhTriangle> triangles;
    uint32_t root = kNoLink; // kNoLink: no triangle; a leaf link: no inner node
    Bounds3 bounds;
    int depth = 0;      // inner nodes on the longest way down; at most kMaxBvhDepth
    float sah_cost = 0; // expected cost of a ray that meets the bounds, in the builder's unit
};

/// What a walk needs; plain pointers, host's or device's.
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
