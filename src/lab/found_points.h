#pragma once

// A search for points in a tree, as a drawing. Photon maps and irradiance caches use these trees
// (accel/kd_tree/point_kd_tree.h, accel/octree/point_octree.h) and these searches; here the points lie in a plane.

#include <cstdint>
#include <string>
#include <vector>

#include "math/vec3.h"

namespace pertev {

/// A search and everything that it visited.
struct FoundPoints {
    const char* tree;                // such as "kd-tree"
    std::vector<Vec3> points;        // in the unit square, z = 0
    Vec3 at;                         // the query point
    float radius_squared = 0;        // the circle about `at` that encloses the found points
    std::vector<uint32_t> found;     // indices of `points`, ascending
    std::vector<uint32_t> tested;    // indices of the points whose distance was computed, ascending
    uint32_t nodes = 0, visited = 0; // number of nodes in the tree, and how many of these the search visited
    struct Line {
        Vec3 from, to;
        bool is_visited; // whether its node was visited
    };
    std::vector<Line> lines; // kd-tree only: the splitting planes, each clipped to its node's cell
    struct Box {
        Vec3 lo, hi;
        bool is_visited; // whether distances to points of its node were computed
    };
    std::vector<Box> boxes; // octree only: the bounding boxes of each leaf's points
};

inline constexpr uint32_t kPointsRequested = 12;

/// Finds the kPointsRequested nearest points. The circle passes through the farthest of them.
FoundPoints found_in_kd_tree();
/// Finds all points within the circle of found_in_kd_tree(), which are the same points.
FoundPoints found_in_octree();

/// Returns, for example, "The search visits 16 of 240 nodes and tests 16 of 240 points (orange); 12 of them ..."
std::string describe(const FoundPoints& found);
/// Returns a complete SVG file.
std::string svg_of(const FoundPoints& found);

} // namespace pertev
