#pragma once

// Everything a ray can meet: one tree over the triangles that are baked into world space, and a tree over instances of
// meshes that keep their own. Which is which is decided in scene preparation, once, for every structure alike.

#include <cstdint>

#include "accel/bvh/bvh.h"
#include "accel/bvh/top_level_bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "base/host_device.h"
#include "math/rigid_motion.h"
#include "math/transform.h"
#include "trace/intersect/ray.h"

namespace pertev {

/// Plain pointers, host's or device's. `Tree` is the view of whatever structure stands over triangles; the tree over
/// instances is always binary.
template <class Tree>
struct SceneTrees {
    Tree baked; // world space; triangles carry their instance
    const BvhNode* top_nodes = nullptr;
    const InstanceRecord* instances = nullptr; // [a leaf link of the top level]
    const Tree* meshes = nullptr;              // [InstanceRecord::mesh_bvh], local space
    uint32_t top_root = kNoLink;
    float top_reach = 0, top_growth = 0; // TopLevelBvh's
};
using SceneBvhView = SceneTrees<BvhView>;
using HostTrees = SceneTrees<WideBvhView<8>>; // what a CPU walks by default (trace/wide/walk_wide.h)

/// A scene all of whose triangles are baked. Its walk has no top level in it, which saves a kernel registers.
template <class Tree>
struct SingleTree {
    Tree baked;
};

/// The ray in an instance's space. The direction is not renormalised, so that t is shared by all spaces.
HD inline Ray transform_ray(const Transform& local_from_world, const Ray& ray) {
    return {transform_point(local_from_world, ray.origin), ray.t_min, transform_vector(local_from_world, ray.direction),
            ray.t_max};
}

/// The ray as an instance meets it that has moved by `motion`, before its transform.
HD inline Ray move_back(const RigidMotion& motion, const Ray& ray) {
    return {motion.move_back(ray.origin), ray.t_min, motion.turn_back(ray.direction), ray.t_max};
}

/// The ray of `accept` in an instance's space, at the time of the ray. A scene with motions is traced with an Accept
/// that knows the ray's time: `Ray move_back(uint32_t motion, const Ray&) const`.
template <class Accept>
HD inline Ray ray_in_instance(const InstanceRecord& record, const Ray& ray, const Accept& accept) {
    if constexpr (requires { accept.move_back(0u, ray); }) {
        if (record.motion != kNoMotion) {
            return transform_ray(record.local_from_world, accept.move_back(record.motion, ray));
        }
    }
    return transform_ray(record.local_from_world, ray);
}

} // namespace pertev
