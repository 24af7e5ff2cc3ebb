#pragma once

// The nodes of a light tree (light_tree.h). Two children lie together, left before right; then come the nodes below the
// left one, then those below the right one. So the position of a leaf determines the way to it, at any depth. The
// lights of a mesh that several instances place have one subtree, in the mesh's space, behind the nodes of the others;
// a leaf stands for each of the instances.

#include <cstdint>

#include "base/host_device.h"
#include "math/vec3.h"

namespace pertev {

/// A node, which holds what the importance needs, so that a step reads 64 bytes.
struct alignas(16) LightTreeNode {
    Vec3 centre;     // middle of its box, metres, translated world, or the mesh's units in a shared subtree
    float power;     // share of the power of all lights in the tree, or in the shared subtree
    float radius;    // half the diagonal of its box
    uint32_t axis;   // axis of the normals' cone (unpack_axis)
    uint32_t angles; // cosines of the cone's half angle, and of the angle from a normal at which light ends; whether
                     // light leaves both faces (LightCone)
    uint32_t next;   // left child, or kLeaf and the number of the light, or both bits and the number of an instance
    static constexpr uint32_t kLeaf = 0x80000000u, kInstance = 0x40000000u;

    HD bool is_leaf() const { return (next & kLeaf) != 0; }
    /// Returns whether the node stands for an instance of a shared subtree.
    HD bool is_instance() const { return (next & (kLeaf | kInstance)) == (kLeaf | kInstance); }
    HD uint32_t number() const { return next & ~(kLeaf | kInstance); }
};
static_assert(sizeof(LightTreeNode) == 32);

/// A placed copy of a shared subtree. Its transform is a rotation, reflections included, a uniform scaling and a
/// translation, which keep all ratios of importances.
struct alignas(16) LightTreeInstance {
    Vec3 local_x, local_y, local_z; // rows of the linear part of local_from_world
    Vec3 origin;                    // middle of the mesh, metres, translated world; local points are relative to it
    float scale;                    // metres per unit of the mesh's space
    uint32_t leaf;                  // its node, 0 if it gives no light
    uint32_t root;                  // root of the shared subtree
    uint32_t first_light;           // number of the light of the mesh's first triangle
    uint32_t first_leaf;            // entry of that triangle in LightTreeView::leaf_of_triangle
};

inline constexpr uint32_t kLightTreeRoot = 1; // pairs of children begin at even numbers

struct LightTreeView {
    const LightTreeNode* nodes = nullptr;    // null: no tree
    const uint32_t* leaf_of_light = nullptr; // [triangles + punctual lights] node of a light, kLeaf and the number of
                                             // an instance, or 0 if it gives no light
    const LightTreeInstance* instances = nullptr;
    const uint32_t* leaf_of_triangle = nullptr; // [triangles of shared subtrees] node in theirs
    uint32_t light_count = 0;                   // lights that have leaves
};

} // namespace pertev
