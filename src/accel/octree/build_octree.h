#pragma once

// Builds the octree over a set of triangles. The tree depends only on the triangles and the settings, not on threads.
//
// Limits: the depth is at most max_depth. There are at most max_references * n references: each node has a budget,
// which its children share by their contents, and a node whose children would exceed it becomes a leaf.

#include <vector>

#include "accel/octree/octree.h"
#include "base/sink.h"

namespace pertev {

struct OctreeSettings {
    int max_depth = 16;           // [0, kMaxOctreeDepth]
    uint32_t max_leaf = 8;        // a cell with at most this many triangles is a leaf
    uint32_t max_references = 16; // per triangle, on average; >= 1
    float node_cost = 1.5f;       // cost of a step over a node's three planes
    float triangle_cost = 1.0f;   // cost of testing one triangle
    Sink* sink = &nobody();       // may end the build
};

/// Builds the tree. Vertices are finite, |coordinate| <= kMaxCoordinate. Throws Error(OverLimit) for more than
/// kMaxOctreeTriangles triangles or kMaxOctreeNodes nodes.
Octree build_octree(const std::vector<BvhTriangle>& triangles, const OctreeSettings& settings = {});

/// Expected cost of a ray that hits the bounds; only the part of a cell within the bounds counts. `sink` may end it.
float octree_sah_cost(const Octree& tree, float node_cost, float triangle_cost, Sink& sink = nobody());

/// Returns the box of a cell in a tree whose root has its lower corner at `corner`.
Bounds3 bounds_of(const OctreeCell& cell, Vec3 corner);

} // namespace pertev
