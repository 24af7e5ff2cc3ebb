#pragma once

// The octree over triangles: cubes split in eight at their centres. A leaf references the triangles that reach into
// its cell, so several leaves may reference one triangle. Only cells that contain triangles have a node; it stores no
// coordinates.
//
// Source: Glassner, "Space Subdivision for Fast Ray Tracing", IEEE CG&A 4(10), 1984. Cells are exact: the root's side
// is a power of two and its corner a multiple of the smallest possible side, which is no less than the margin by
// which a traversal moves planes. Thus every plane is a float that is computed without rounding.

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "math/bounds3.h"

namespace pertev {

inline constexpr int kMaxOctreeDepth = 20;                // inner nodes on any path, and the size of a traversal
                                                          // stack
inline constexpr uint32_t kMaxOctreeNodes = 1u << 31;     // an index has 32 bits, the sum of two must not overflow
inline constexpr uint32_t kMaxOctreeTriangles = 1u << 30; // a leaf's count has 31 bits

/// Child k is the octant above the centre along x, y, z if bit 0, 1, 2 of k is set.
struct alignas(8) OctreeNode {
    uint32_t first; // inner node: its first existing child, which the others follow; leaf: its first reference
    uint32_t link;  // kLeafBit | count of references; or a bit for each existing child

    HD bool is_leaf() const { return (link & kLeafBit) != 0; }
    HD uint32_t count() const { return link & ~kLeafBit; }
    HD bool has_child(uint32_t k) const { return (link >> k & 1) != 0; }
    HD uint32_t child(uint32_t k) const { return first + count_bits(link & ((1u << k) - 1)); }

    /// Number of bits set in the low 8 bits.
    HD static uint32_t count_bits(uint32_t x) {
        x = (x & 0x55) + (x >> 1 & 0x55);
        x = (x & 0x33) + (x >> 2 & 0x33);
        return (x & 0x0f) + (x >> 4 & 0x0f);
    }
};
static_assert(sizeof(OctreeNode) == 8);

struct Octree {
    std::vector<OctreeNode> nodes;      // [0] is the root, and children come after their parent; empty if there is no
                                        // triangle
    std::vector<uint32_t> references;   // positions in `triangles`, ascending within a leaf
    std::vector<BvhTriangle> triangles; // the builder's input
    Bounds3 bounds;                     // bounds of the triangles, within the root's cell
    Vec3 corner;                        // lower corner of the root's cell
    float side = 0;                     // side of the root's cell
    int depth = 0;                      // inner nodes on the longest path
    float sah_cost = 0;                 // expected cost of a ray that hits the bounds, in the builder's unit
};

/// Arrays of an Octree for traversal, as plain pointers of host or device.
struct OctreeView {
    const OctreeNode* nodes = nullptr; // null if there is no triangle
    const uint32_t* references = nullptr;
    const BvhTriangle* triangles = nullptr;
    Bounds3 bounds;
    Vec3 corner;
    float side = 0;
};

inline OctreeView view_of(const Octree& tree) {
    if (tree.nodes.empty()) return {};
    return {tree.nodes.data(), tree.references.data(), tree.triangles.data(), tree.bounds, tree.corner, tree.side};
}

/// A cell; its position counts cells of its own level from the root's corner.
struct OctreeCell {
    uint32_t x = 0, y = 0, z = 0;
    float half; // half of its side

    HD OctreeCell child(uint32_t k) const {
        return {2 * x + (k & 1), 2 * y + (k >> 1 & 1), 2 * z + (k >> 2 & 1), 0.5f * half};
    }
    HD OctreeCell parent() const { return {x >> 1, y >> 1, z >> 1, 2 * half}; }
    /// Centre of the cell; its faces are half a side away.
    HD Vec3 centre(Vec3 corner) const {
        return {corner.x + static_cast<float>(2 * x + 1) * half, corner.y + static_cast<float>(2 * y + 1) * half,
                corner.z + static_cast<float>(2 * z + 1) * half};
    }
};

} // namespace pertev
