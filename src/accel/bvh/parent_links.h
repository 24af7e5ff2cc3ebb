#pragma once

// What a walk without a stack needs to find its way up a binary tree: each node's parent, and the axis along which its
// children lie apart, by which a ray can tell the near one at any time and always alike.
//
// Source: Hapala, Davidovic, Wald, Havran, Slusallek, "Efficient Stack-less BVH Traversal for Ray Tracing", SCCG 2011.

#include <optional>
#include <string>

#include "accel/bvh/bvh.h"

namespace pertev {

// BvhNode::parent: index of the parent, and this bit where the node is its child 1. kNoLink at the root.
inline constexpr uint32_t kSecondChildBit = 0x80000000u;
// BvhNode::split: the axis along which the children's centres are furthest apart, and this bit where child 1 is the
// one whose centre is lower there.
inline constexpr uint32_t kSecondIsLower = 4;

/// Fills BvhNode::parent and BvhNode::split. Whoever changes the tree afterwards calls it again.
void add_parent_links(Bvh& bvh);

/// What is wrong with them; nothing when they lead from every node to the root. A tree without inner nodes needs none.
std::optional<std::string> find_parent_link_fault(const Bvh& bvh);

} // namespace pertev
