#pragma once

// Makes a finished binary tree better: subtrees are taken out and put back where boxes grow least, on all threads.
//
// Source: Meister, Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", CGF 2018. Each pass
// looks for the best place of many nodes in the tree as it stands; of moves that touch the same links the one that
// gains most is made. Which those are depends neither on threads nor on where nodes lie but by their numbers.

#include "accel/builders/binary_tree.h"
#include "accel/builders/builders.h"

namespace pertev {

/// Inner nodes' boxes are the unions of their children's, before and after. Moves made at once may take some of each
/// other's gain.
void reinsert_subtrees(BinaryTree& tree, const ReinsertionSettings& settings = {});

} // namespace pertev
