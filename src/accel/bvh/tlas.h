#pragma once

// The top-level structure (TLAS): a tree over instances. Its leaves name instance records, each a BLAS (the tree of one
// mesh in its own space) and the transform into that space.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "accel/bvh/bvh.h"
#include "math/motion_keys.h"
#include "math/transform.h"

namespace pertev {

inline constexpr int kMaxTlasDepth = 32; // inner nodes on any path; 2^30 instances need 30

struct alignas(16) InstanceRecord {
    Transform local_from_world;
    uint32_t blas = 0;           // index into SceneBvhView::blases
    uint32_t instance = 0;       // scene order
    uint32_t motion = kNoMotion; // index of its motion while the shutter is open, which then gives local_from_world
    uint32_t unused = 0;
};
static_assert(sizeof(InstanceRecord) == 64);

/// An instance as the scene gives it.
struct PlacedBvh {
    Transform world_from_local;
    Bounds3 local_bounds; // bounds of the BLAS
    uint32_t blas = 0;
    uint32_t instance = 0;
    std::shared_ptr<const MotionKeys> motions; // motions while the shutter is open; null if it stands still
    uint32_t motion = kNoMotion;               // index into `motions`
};

struct Tlas {
    std::vector<BvhNode> nodes;
    std::vector<InstanceRecord> instances; // a leaf link is kLeafBit | position here
    uint32_t root = kNoLink;
    Bounds3 bounds;   // world space
    float reach = 0;  // metres; no term of any instance's transform of a point in its bounds exceeds this
    float growth = 0; // boxes grow by this multiple of e; see build_tlas
    int depth = 0;
};

/// Builds the tree over instances in the given order, without instances of empty meshes. Transforms are invertible
/// and everything is finite.
/// Growth: let M be an instance's linear part, T its translation, K = |M| |M^-1|, u = 2^-24, o the ray's origin and R
/// = reach >= |T| + |M| |p| for p in the mesh's bounds. In local space, rounding of the transformed origin and of t
/// times the transformed direction is at most u |M^-1| (4 |o| + 4 |T| + 3 |o| + 3 R), that of the stored inverse u
/// |M^-1| (2 |o| + 2 R), and the triangle test's own 6 u |M^-1| (|o| + |T| + R). Back in the world that is at most 15
/// u K (|o| + |T| + R) <= 30 u K (|o| + R). Boxes grow by 32 u K (|o| + R) here: growth = 2 K, e = 2^-20 (|o| + R). A
/// moving instance has the box of all its positions. Its ray is first moved back (RigidMotion), with an error of at
/// most 16 u (|o| + |pivot| + |position|) and as much in t times the rotated direction: growth is 16 more, and R
/// includes pivots and positions.
Tlas build_tlas(std::span<const PlacedBvh> instances);

} // namespace pertev
