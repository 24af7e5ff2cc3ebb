#pragma once

// Builds the kd-tree over a set of triangles, by spatial median or by the surface area heuristic (sah_kd_splitter.h).
// The tree is a function of the triangles and the settings: neither the number of threads nor their timing enters.
//
// Bounds: depth at most 8 + 1.3 log2(n) (Havran 2000), never over kMaxKdTreeDepth; references at most
// max_references * n: each node has a share of them, which its children divide by what they hold, and a node whose
// children would hold more than its share is a leaf.

#include <cstdint>
#include <vector>

#include "accel/kd_tree/kd_tree.h"

namespace pertev {

enum class KdSplit {
    SpatialMedian, // halves the longest side until few triangles are left
    Sah,
};

struct KdTreeSettings {
    KdSplit split = KdSplit::Sah;
    int max_depth = kMaxKdTreeDepth; // [0, kMaxKdTreeDepth]; 8 + 1.3 log2(n) holds beside it
    uint32_t max_leaf = 4;           // spatial median: a cell with no more triangles is a leaf
    uint32_t max_references = 16;    // a triangle, on average; >= 1
    float node_cost = 0.5f;          // of a step over one plane
    float triangle_cost = 1.0f;      // of testing one triangle
    float empty_bonus = 0.2f;        // [0, 1): by how much a cut that leaves a side empty is cheaper
};

/// Vertices are finite, |coordinate| <= kMaxCoordinate. Throws Error(OverLimit) for more than kMaxKdTreeTriangles
/// triangles or kMaxKdTreeNodes nodes.
KdTree build_kd_tree(const std::vector<BvhTriangle>& triangles, const KdTreeSettings& settings = {});

/// Half the area that rays see of a cell: its planes are moved out by what a walk from within the bounds moves them, so
/// that a flat cell has some too.
double kd_cell_area(const Bounds3& cell, float max_abs);

/// The expected cost of a ray that meets the bounds.
float kd_tree_sah_cost(const KdTree& tree, float node_cost, float triangle_cost);

} // namespace pertev
