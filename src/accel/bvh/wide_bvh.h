#pragma once

// The same tree with up to eight children a node, for walks that test eight boxes at once on the host. Made from a
// binary tree: each node takes in the inner children with the largest boxes until it has eight.
//
// Source: Wald, Benthin, Boulos, "Getting Rid of Packets", IEEE RT 2008; Dammertz, Hanika, Keller, "Shallow Bounding
// Volume Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays", EGSR 2008.

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"

namespace pertev {

inline constexpr int kWideChildren = 8;

struct alignas(64) WideBvhNode {
    float planes[6][kWideChildren]; // lower x, upper x, lower y, upper y, lower z, upper z; a place left empty: +-inf
    uint32_t child[kWideChildren];  // index of a node here, or kLeafBit | first triangle; kNoLink: empty
    uint32_t count[kWideChildren];  // triangles of a leaf; 0: an inner node, or empty
};
static_assert(sizeof(WideBvhNode) == 256);

/// Nodes in depth-first order, [0] the root; none where the tree has no inner node. No deeper than the tree. They are
/// what BvhView::wide wants, beside the tree's own triangles.
std::vector<WideBvhNode> make_wide_nodes(const Bvh& bvh);

} // namespace pertev
