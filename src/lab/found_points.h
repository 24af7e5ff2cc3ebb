#pragma once

// Points found in a tree, as a drawing: the trees are those that photon maps and irradiance caches look things up in
// (accel/kd_tree/point_kd_tree.h, accel/octree/point_octree.h), over points of a plane, and the search is theirs.

#include <cstdint>
#include <string>
#include <vector>

#include "math/vec3.h"

namespace pertev {

/// A search and what it met.
struct FoundPoints {
    const char* tree;                // "kd-tree"
    std::vector<Vec3> points;        // in the unit square, z = 0
    Vec3 at;                         // the place whose neighbours were asked for
    float radius_squared = 0;        // of the circle about it that holds what was found
    std::vector<uint32_t> found;     // indices of `points`, ascending
    std::vector<uint32_t> looked_at; // whose distance was taken, ascending
    uint32_t nodes = 0, visited = 0; // of the tree; of these the search came to
    struct Line {
        Vec3 from, to;
        bool is_visited; // its node is
    };
    std::vector<Line> lines; // of a kd-tree: planes of nodes within their cells
    struct Box {
        Vec3 lo, hi;
        bool is_visited; // points of its node were looked at
    };
    std::vector<Box> boxes; // of an octree: of the points of each leaf
};

inline constexpr uint32_t kPointsAsked = 12;

/// The kPointsAsked nearest ones. The circle goes through the farthest of these.
FoundPoints found_in_kd_tree();
/// All within the circle of found_in_kd_tree(), so the same ones.
FoundPoints found_in_octree();

/// "16 of 240 nodes are visited and 16 of 240 points looked at: orange; found are 12: green."
std::string describe(const FoundPoints& found);
/// A file by itself.
std::string svg_of(const FoundPoints& found);

} // namespace pertev
