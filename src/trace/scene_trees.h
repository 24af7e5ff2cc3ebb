#pragma once

// Everything that rays can hit: a tree over the triangles that are baked into world space, and a TLAS over the other
// instances, each of which names a BLAS. Scene preparation decides between the two, the same for every structure.

#include <cstdint>

#include "accel/bvh/bvh.h"
#include "accel/bvh/tlas.h"
#include "accel/bvh/wide_bvh.h"
#include "base/host_device.h"
#include "math/rigid_motion.h"
#include "math/transform.h"
#include "trace/intersect/ray.h"

namespace pertev {

/// The trees of a scene, as plain pointers of host or device. `Tree` is the view of the structure over triangles; the
/// tree over instances is always binary.
template <class Tree>
struct SceneTrees {
    Tree baked; // world space; triangles carry their instance
    const BvhNode* tlas_nodes = nullptr;
    const InstanceRecord* instances = nullptr; // indexed by leaf links of the TLAS
    const Tree* blases = nullptr;              // [InstanceRecord::blas], local space
    uint32_t tlas_root = kNoLink;
    float tlas_reach = 0, tlas_growth = 0; // values of Tlas
};
using SceneBvhView = SceneTrees<BvhView>;
using HostTrees = SceneTrees<WideBvhView<8>>; // the CPU's default structure (trace/wide/traverse_wide.h)

/// A scene whose triangles are all baked. Its traversal has no TLAS, which saves registers in a kernel.
template <class Tree>
struct SingleTree {
    Tree baked;
};

/// Transforms the ray to an instance's space. The direction is not renormalised, so that all spaces share t.
HD inline Ray transform_ray(const Transform& local_from_world, const Ray& ray) {
    return {transform_point(local_from_world, ray.origin), ray.t_min, transform_vector(local_from_world, ray.direction),
            ray.t_max};
}

/// Moves the ray to the rest position of an instance that has moved by `motion`, before its transform.
HD inline Ray move_back(const RigidMotion& motion, const Ray& ray) {
    return {motion.move_back(ray.origin), ray.t_min, motion.rotate_back(ray.direction), ray.t_max};
}

/// Transforms the ray to an instance's space at the ray's time. A scene with motions needs an Accept that knows the
/// ray's time: `Ray move_back(uint32_t motion, const Ray&) const`.
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
