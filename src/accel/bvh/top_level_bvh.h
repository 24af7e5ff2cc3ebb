#pragma once

// The tree over instances: its leaves name instance records, each a mesh's own tree and the way into its space.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "accel/bvh/bvh.h"
#include "math/motion_keys.h"
#include "math/transform.h"

namespace pertev {

inline constexpr int kMaxTopLevelDepth = 32; // inner nodes on any way down; 2^30 instances need 30

struct alignas(16) InstanceRecord {
    Transform local_from_world;
    uint32_t mesh_bvh = 0;       // index into SceneBvhView::meshes
    uint32_t instance = 0;       // scene order
    uint32_t motion = kNoMotion; // while the shutter is open: from where local_from_world has it
    uint32_t unused = 0;
};
static_assert(sizeof(InstanceRecord) == 64);

/// One instance as the scene gives it.
struct PlacedBvh {
    Transform world_from_local;
    Bounds3 local_bounds; // of the mesh's tree
    uint32_t mesh_bvh = 0;
    uint32_t instance = 0;
    std::shared_ptr<const MotionKeys> motions; // while the shutter is open; null: it stands still
    uint32_t motion = kNoMotion;               // its number in them
};

struct TopLevelBvh {
    std::vector<BvhNode> nodes;
    std::vector<InstanceRecord> instances; // a leaf link is kLeafBit | position here
    uint32_t root = kNoLink;
    Bounds3 bounds;   // world space
    float reach = 0;  // no step of any instance's transform of a point in its bounds exceeds this, metres
    float growth = 0; // how many times e the boxes move out; see build_top_level_bvh
    int depth = 0;
};

/// The tree over instances, in the order given; instances of empty meshes are left out. Transforms are invertible and
/// everything is finite.
///
/// Growth: let M be an instance's linear part, T its translation, K = |M| |M^-1|, u = 2^-24, o the ray's origin and
/// R = reach >= |T| + |M| |p| for p in the mesh's bounds. In the local space, rounding of the moved origin and of
/// t times the moved direction is at most u |M^-1| (4 |o| + 4 |T| + 3 |o| + 3 R), that of the stored inverse
/// u |M^-1| (2 |o| + 2 R), and the triangle test's own 6 u |M^-1| (|o| + |T| + R). Back in the world that is at most
/// 15 u K (|o| + |T| + R) <= 30 u K (|o| + R). Boxes grow by 32 u K (|o| + R) here: growth = 2 K, e = 2^-20 (|o| + R).
/// An instance that moves has the box of all places that it takes. Its ray is first moved back (RigidMotion), which is
/// off by at most 16 u (|o| + |pivot| + |place|) there and as much in t times the turned direction: growth is 16 more,
/// and R holds pivot and places.
TopLevelBvh build_top_level_bvh(std::span<const PlacedBvh> instances);

} // namespace pertev
