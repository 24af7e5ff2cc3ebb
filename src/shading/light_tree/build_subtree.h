#pragma once

// Builds one tree of lights, top down, by Conty Estevez and Kulla's surface area orientation heuristic over bins. It
// does not depend on the number of threads.

#include <cstdint>
#include <span>

#include "math/bounds3.h"
#include "shading/light_tree/light_tree_view.h"

namespace pertev {

/// A light to be put into a tree.
struct TreeLight {
    Bounds3 bounds;           // metres, or the mesh's units in a shared subtree
    Vec3 axis;                // unit normal, or the axis of a spot; any if light leaves in all directions
    float spread = 0;         // half angle of the cone of normals about the axis, radians; only of instances
    float emission_angle = 0; // within which light leaves from a normal, radians; pi: in all directions
    bool has_two_sides = false;
    double power = 0; // pi times its largest intensity, which is the power of a diffuse face, W; 0: it is left out
};

/// A cone of normals, and the directions in which light leaves from one.
struct NormalCone {
    Vec3 axis = {0, 0, 1};
    float normals = 0, emission = 0; // half angle of normals, angle of emission about one; radians
    bool has_two_sides = false;
};

/// Arrays that a tree is stored in. Its first node is an empty one, so that pairs of children begin at even numbers.
struct TreePlace {
    LightTreeNode* nodes;    // nodes of all trees
    uint32_t first_node;     // even
    uint32_t* leaf_of_light; // [lights]
    uint32_t light_count;    // lights from this one on are instances of shared subtrees
};

/// Returns whether a tree holds a light of this power. It is infinite where the square of an area overflows.
bool has_leaf(double power);
uint32_t count_leaves(std::span<const TreeLight> lights);

/// Builds the tree over the lights that have a leaf, which are one or more, and returns the cone of their normals.
NormalCone build_subtree(std::span<const TreeLight> lights, const TreePlace& to);

} // namespace pertev
