#pragma once

// What rays meet, for loops over rays on the host: by the walk of several rays in turns, with the same rules of what
// counts as the tracers of queues have (device_scene/accept_queued.h).

#include <cstdint>

#include "device_scene/accept_hit.h"
#include "trace/wide/trace_many.h"

namespace pertev {

/// hits[i] is what ray_of(i) meets first of what accept_of(i) lets count, for `count` rays.
template <class RayOf, class AcceptOf>
inline void find_hits(const HostTrees& trees, uint32_t count, RayOrder order, const RayOf& ray_of,
                      const AcceptOf& accept_of, Hit* hits) {
    trace_closest_many<WalkOptions{}>(trees, count, order, ray_of, accept_of, hits);
}

/// Finds the same for rays that come from the camera, or have bounced. Backs that are hidden from the camera do not
/// count to its own rays (AcceptCameraHit).
template <class RayOf, class AcceptOf>
inline void find_hits(const HostTrees& trees, const SceneView& scene, bool from_camera, uint32_t count,
                      const RayOf& ray_of, const AcceptOf& accept_of, Hit* hits) {
    const RayOrder order = from_camera ? RayOrder::Together : RayOrder::Scattered;
    if (!from_camera || scene.any_hidden_back == 0) return find_hits(trees, count, order, ray_of, accept_of, hits);
    const auto accept_camera = [&](uint32_t i) { return AcceptCameraHit{accept_of(i), ray_of(i).direction}; };
    find_hits(trees, count, order, ray_of, accept_camera, hits);
}

/// Whether each of `count` rays meets anything.
template <class RayOf, class AcceptOf>
inline void find_occlusions(const HostTrees& trees, uint32_t count, RayOrder order, const RayOf& ray_of,
                            const AcceptOf& accept_of, bool* met) {
    // Of several children, the builder put first where such searches end sooner. Of rays without an end the farthest is
    // a better start (trace/trace_any.h).
    trace_any_many<WalkOptions{.near_first = false}>(trees, count, order, ray_of, accept_of, met);
}

} // namespace pertev
