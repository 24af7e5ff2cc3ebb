#pragma once

// The compressed 8-wide tree with 80 bytes per node: boxes in 8 bits per plane, rounded outwards, on a grid that each
// node sets for its children. Five loads of 16 bytes fetch eight boxes.
//
// Source: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017,
// sections 3 and 4. Unlike theirs, a node describes the triangles of its leaves in one word with three masks of
// children, so that a multiplication turns a mask of children into one of triangles. The slot of a child encodes its
// position: the child in slot s comes early for rays that travel into octant s (bit 0: x decreases, bit 1: y, bit 2:
// z). A ray of octant r visits slots in ascending order of s ^ r, or in descending order for far children first, and
// needs no sorting.

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "base/host_device.h"

namespace pertev {

inline constexpr int kCompressedLeaf = 3; // maximum number of triangles per leaf

/// Default settings. With leaves of two, rays in Sponza test 6 % fewer triangles and 1 % more nodes than with three,
/// and are 1 to 2 % faster; there is no difference in the bunny.
inline constexpr CollapseSettings kCompressedCollapse = {.max_leaf = 2};

// From 2^-80 on, the quantum divided by a ray's direction is a normal float. At 2^34, 255 quanta span [-2^40, 2^40].
inline constexpr uint32_t kMinQuantumExponent = 127 - 80, kMaxQuantumExponent = 127 + 34;

inline constexpr uint32_t kByteBase = 0x47000000u; // 2^15 as a float; with a byte q in bits 8 to 15 it is 2^15 + q

struct alignas(16) CompressedBvhNode {
    float origin[3];                // origin of the grid, 2^15 quanta below the corner of its contents; with kByteBase,
                                    // a plane is origin + (2^15 + q) quanta
    uint32_t exponents_and_inner;   // bits 8 a .. 8 a + 7: exponent of axis a's quantum, as in a float; bit 24 + s:
                                    // slot s is an inner node
    uint32_t triangle_base = 0;     // first triangle of the leaves, ordered as the bits of `triangles`; one load reads
                                    // both
    uint32_t triangles = 0;         // bit 8 k + s: slot s is a leaf of more than k triangles
    uint32_t child_base = 0;        // first of the inner children's nodes, ordered by slot
    uint32_t byte_base = kByteBase; // kByteBase is read from here so that it is in a register for a traversal's byte
                                    // permutations; as a constant it would be moved to a register for each of them
    uint32_t planes[6][2]; // lower x, upper x, lower y, ... in quanta from the origin; byte s % 4 of word s / 4
                           // belongs to slot s. Empty slots have 255 to 0, and their test results are masked out
};
static_assert(sizeof(CompressedBvhNode) == 80);

HD inline uint32_t inner_slots(const CompressedBvhNode& node) { return node.exponents_and_inner >> 24; }
/// Bits in `triangles` of all triangles of these slots.
HD inline uint32_t triangles_of_slots(const CompressedBvhNode& node, uint32_t slots) {
    return node.triangles & slots * 0x010101u;
}
HD inline float quantum(const CompressedBvhNode& node, int axis) {
    return float_of((node.exponents_and_inner >> (8 * axis) & 0xff) << 23);
}

struct CompressedBvh {
    std::vector<CompressedBvhNode> nodes; // [0] is the root; the inner children of a node are contiguous
    std::vector<BvhTriangle> triangles;
    Bounds3 bounds;
    int depth = 0;      // nodes on the longest path, and thus the stack size of a traversal; at most kMaxBvhDepth
    float sah_cost = 0; // SAH cost of the wide tree from which it was made
};

/// Arrays of a CompressedBvh for traversal, as plain pointers of host or device.
struct CompressedBvhView {
    const CompressedBvhNode* nodes = nullptr; // null if there is no triangle
    const BvhTriangle* triangles = nullptr;
    float bounds_max_abs = 0; // largest |coordinate| of the bounds
};

CompressedBvhView view_of(const CompressedBvh& bvh);

/// Compresses a wide tree whose leaves hold at most kCompressedLeaf triangles. The result does not depend on the
/// number of threads.
CompressedBvh compress(const WideBvh<8>& wide, Sink& sink = nobody());

/// Collapses a binary tree with the least cost and compresses it. max_leaf is at most kCompressedLeaf.
CompressedBvh make_compressed_bvh(const Bvh& bvh, const CollapseSettings& settings = kCompressedCollapse,
                                  Sink& sink = nobody());

/// Sets the grid for `slots`, of which at least one is not empty, and quantizes them outwards.
void set_boxes(CompressedBvhNode& node, const Bounds3 (&slots)[8]);

/// Assigns up to 8 children to slots with the least sum of distances along the slots' octants. Slots of kNoLink stay
/// empty.
void assign_slots(const WideBvhNode<8>& node, int (&child_of_slot)[8]); // -1: empty

} // namespace pertev
