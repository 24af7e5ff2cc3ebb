#pragma once

// Optimizes a finished binary tree: subtrees are removed and reinserted where boxes grow least, on all threads.
//
// Source: Meister, Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", CGF 2018. Each pass
// finds the best position for many nodes in the present tree. Of the moves that touch the same links, the one with
// the highest gain is made. The result depends neither on threads nor on the layout of nodes, except for their
// numbers.

#include "accel/builders/binary_tree.h"
#include "accel/builders/builders.h"

namespace pertev {

/// Improves `tree`. Inner boxes are the unions of their children's, before and after. Simultaneous moves may reduce
/// each other's gain.
void reinsert_subtrees(BinaryTree& tree, const ReinsertionSettings& settings = {}, Sink& sink = nobody());

} // namespace pertev
