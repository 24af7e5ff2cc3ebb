#pragma once

// Links for stackless traversal of a binary tree: each node's parent, and the axis along which its children are
// farthest apart, by which a ray can identify the near child at any time.
//
// Source: Hapala, Davidovic, Wald, Havran, Slusallek, "Efficient Stack-less BVH Traversal for Ray Tracing", SCCG 2011.

#include "accel/bvh/bvh.h"
#include "base/sink.h"

namespace pertev {

// BvhNode::parent is the index of the parent, with this bit set in the parent's child 1. It is kNoLink at the root.
inline constexpr uint32_t kSecondChildBit = 0x80000000u;
// BvhNode::split is the axis along which the children's centres are farthest apart, with this bit set if child 1 has
// the lower centre there.
inline constexpr uint32_t kSecondIsLower = 4;

/// Fills BvhNode::parent and BvhNode::split. It must be called again after the tree changes. `sink` may end it.
void add_parent_links(Bvh& bvh, Sink& sink = nobody());

} // namespace pertev
