#pragma once

// Builds the octree over a set of triangles. The tree is a function of the triangles and the settings: neither the
// number of threads nor their timing enters.
//
// Bounds: depth at most max_depth; references at most max_references * n: each node has a share of them, which its
// children divide by what they hold, and a node whose children would hold more than its share is a leaf.

#include <vector>

#include "accel/octree/octree.h"

namespace pertev {

struct OctreeSettings {
    int max_depth = 16;           // [0, kMaxOctreeDepth]
    uint32_t max_leaf = 8;        // a cell with no more triangles is a leaf
    uint32_t max_references = 16; // a triangle, on average; >= 1
    float node_cost = 1.5f;       // of a step over the three planes of a node
    float triangle_cost = 1.0f;   // of testing one triangle
};

/// Vertices are finite, |coordinate| <= kMaxCoordinate. Throws Error(OverLimit) for more than kMaxOctreeTriangles
/// triangles or kMaxOctreeNodes nodes.
Octree build_octree(const std::vector<BvhTriangle>& triangles, const OctreeSettings& settings = {});

/// The expected cost of a ray that meets the bounds; only the part of a cell within the bounds counts.
float octree_sah_cost(const Octree& tree, float node_cost, float triangle_cost);

/// The cell's box.
Bounds3 bounds_of(const OctreeCell& cell, Vec3 corner);

} // namespace pertev
