#pragma once

// Builds the kd-tree over a set of triangles, by spatial median or by the surface area heuristic (sah_kd_splitter.h).
// The tree depends only on the triangles and the settings, not on threads.
//
// Limits: the depth is at most 8 + 1.3 log2(n) (Havran 2000) and never over kMaxKdTreeDepth. There are at most
// max_references * n references: each node has a budget, which its children share by their contents, and a node whose
// children would exceed it becomes a leaf.

#include <cstdint>
#include <vector>

#include "accel/kd_tree/kd_tree.h"
#include "base/sink.h"

namespace pertev {

enum class KdSplit {
    SpatialMedian, // splits the longest side in the middle until few triangles are left
    Sah,
};

struct KdTreeSettings {
    KdSplit split = KdSplit::Sah;
    int max_depth = kMaxKdTreeDepth; // [0, kMaxKdTreeDepth]; 8 + 1.3 log2(n) is a limit too
    uint32_t max_leaf = 4;           // spatial median: a cell with at most this many triangles is a leaf
    uint32_t max_references = 16;    // per triangle, on average; >= 1
    float node_cost = 0.5f;          // cost of a traversal step
    float triangle_cost = 1.0f;      // cost of testing one triangle
    float empty_bonus = 0.2f;        // [0, 1): relative bonus of a split that leaves a side empty
    Sink* sink = &nobody();          // may end the build
};

/// Builds the tree. Vertices are finite, |coordinate| <= kMaxCoordinate. Throws Error(OverLimit) for more than
/// kMaxKdTreeTriangles triangles or kMaxKdTreeNodes nodes.
KdTree build_kd_tree(const std::vector<BvhTriangle>& triangles, const KdTreeSettings& settings = {});

/// Half the area of a cell after its planes have moved out by the margin that a traversal uses within the bounds.
/// Thus a flat cell has an area too.
double kd_cell_area(const Bounds3& cell, float max_abs);

/// Expected cost of a ray that hits the bounds. `sink` may end it.
float kd_tree_sah_cost(const KdTree& tree, float node_cost, float triangle_cost, Sink& sink = nobody());

} // namespace pertev
