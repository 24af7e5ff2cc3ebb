#pragma once

// The nodes of a light tree (light_tree.h). Two children lie together, left before right; then come the nodes below the
// left one, then those below the right one. So the position of a leaf determines the way to it, at any depth.

#include <cstdint>

#include "base/host_device.h"
#include "math/vec3.h"

namespace pertev {

/// A node, which holds what the importance needs, so that a step reads 64 bytes.
struct alignas(16) LightTreeNode {
    Vec3 centre;     // middle of its box, metres, translated world
    float power;     // share of the power of all lights in the tree
    float radius;    // half the diagonal of its box
    uint32_t axis;   // axis of the normals' cone (unpack_axis)
    uint32_t angles; // cosines of the cone's half angle, and of the angle from a normal at which light ends; whether
                     // light leaves both faces (LightCone)
    uint32_t next;   // left child, or kLeaf and the number of the light
    static constexpr uint32_t kLeaf = 0x80000000u;

    HD bool is_leaf() const { return (next & kLeaf) != 0; }
    HD uint32_t light() const { return next & ~kLeaf; }
};
static_assert(sizeof(LightTreeNode) == 32);

inline constexpr uint32_t kLightTreeRoot = 1; // pairs of children begin at even numbers

struct LightTreeView {
    const LightTreeNode* nodes = nullptr;    // null: no tree
    const uint32_t* leaf_of_light = nullptr; // [triangles + punctual lights] node of a light, or 0 if it gives no light
    uint32_t light_count = 0;                // lights that have leaves
};

} // namespace pertev
