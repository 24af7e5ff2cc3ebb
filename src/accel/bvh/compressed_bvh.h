#pragma once

// The 8-wide tree in 80 bytes a node: boxes in 8 bits a plane, rounded outwards, on a grid that each node lays over its
// children. Five loads of 16 bytes fetch eight boxes.
//
// Source: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", HPG 2017,
// sections 3 and 4. Unlike theirs, a node says which triangles its leaves have in one word of three masks of children,
// so that a walk turns a mask of children into one of triangles by a multiplication. A child's place (slot)
// tells where it lies: the one in slot s comes early for rays that travel into octant s (bit 0: x decreases, bit 1: y,
// bit 2: z), so a ray of octant r takes slots in ascending order of s ^ r, or the far ones first in descending order,
// and sorts nothing.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "accel/bvh/bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "base/host_device.h"

namespace pertev {

inline constexpr int kCompressedLeaf = 3; // triangles of a leaf at most

/// Leaves of two: Sponza's rays test 6 % fewer triangles and 1 % more nodes than with three, and are 1 to 2 % faster;
/// the bunny's are as fast.
inline constexpr CollapseSettings kCompressedCollapse = {.max_leaf = 2};

// 2^-80: then the quantum divided by what a ray moves is a normal float. 2^34: 255 of them span [-2^40, 2^40].
inline constexpr uint32_t kMinQuantumExponent = 127 - 80, kMaxQuantumExponent = 127 + 34;

inline constexpr uint32_t kByteBase = 0x47000000u; // as a float 2^15; with a byte q in bits 8 to 15, 2^15 + q

struct alignas(16) CompressedBvhNode {
    float origin[3];              // of its grid, 2^15 quanta below the corner of what it holds: with kByteBase, a plane
                                  // is origin + (2^15 + q) quanta
    uint32_t exponents_and_inner; // bits 8 a .. 8 a + 7: exponent of axis a's quantum, as in a float; 24 + s: slot s is
                                  // an inner node
    uint32_t triangle_base = 0;   // the leaves' triangles, in the order of the bits of `triangles`; one load takes both
    uint32_t triangles = 0;       // bit 8 k + s: slot s is a leaf of more than k triangles
    uint32_t child_base = 0;      // the inner children's nodes, in the order of slots
    uint32_t byte_base = kByteBase; // read from here, it is in a register where a walk's byte permutations need it;
                                    // written in the code, each of them would first have its pattern moved to one
    uint32_t planes[6][2]; // lower x, upper x, lower y, ... in quanta from the origin; byte s % 4 of word s / 4 is slot
                           // s. Empty slots: 255 to 0; what a test says of them is masked out
};
static_assert(sizeof(CompressedBvhNode) == 80);

HD inline uint32_t inner_slots(const CompressedBvhNode& node) { return node.exponents_and_inner >> 24; }
/// The bits in `triangles` of all triangles of these slots.
HD inline uint32_t triangles_of_slots(const CompressedBvhNode& node, uint32_t slots) {
    return node.triangles & slots * 0x010101u;
}
HD inline float quantum(const CompressedBvhNode& node, int axis) {
    return float_of((node.exponents_and_inner >> (8 * axis) & 0xff) << 23);
}

struct CompressedBvh {
    std::vector<CompressedBvhNode> nodes; // [0] the root; the inner children of a node lie together
    std::vector<BvhTriangle> triangles;
    Bounds3 bounds;
    int depth = 0;      // nodes on the longest way down; at most kMaxBvhDepth, and what a walk's stack needs
    float sah_cost = 0; // of the wide tree that it was made from
};

/// What a walk needs; plain pointers, host's or device's.
struct CompressedBvhView {
    const CompressedBvhNode* nodes = nullptr; // null where there is no triangle
    const BvhTriangle* triangles = nullptr;
    float bounds_max_abs = 0; // largest |coordinate| of the bounds
};

CompressedBvhView view_of(const CompressedBvh& bvh);

/// Leaves of `wide` hold at most kCompressedLeaf triangles. The same for any number of threads.
CompressedBvh compress(const WideBvh<8>& wide);

/// The collapse of least cost, compressed. max_leaf is at most kCompressedLeaf.
CompressedBvh make_compressed_bvh(const Bvh& bvh, const CollapseSettings& settings = kCompressedCollapse);

/// Whether links are sound, each node and triangle is reached once, the depth is as stated, and every decoded box, as
/// the exact numbers that it stands for, holds every triangle beneath it. Nothing when it is sound, else what is wrong.
/// `clipped`: the tree has spatial splits, so a box need only meet the triangles beneath it.
std::optional<std::string> find_fault(const CompressedBvh& bvh, bool clipped = false);

/// Lays the grid over `slots` (empty ones are left out; one is not) and rounds them outwards.
void set_boxes(CompressedBvhNode& node, const Bounds3 (&slots)[8]);

/// Whether the decoded box of a slot holds a box, decided exactly.
bool holds(const CompressedBvhNode& node, int slot, const Bounds3& box);

/// The slots of up to 8 children by least sum of their distances along the slots' octants; kNoLink's stay empty.
void assign_slots(const WideBvhNode<8>& node, int (&child_of_slot)[8]); // -1: empty

} // namespace pertev
