#pragma once

// Ray queries for loops over rays on the host: interleaved traversal of several rays, with the acceptance rules of
// the queue tracers (device_scene/accept_queued.h).

#include <cstdint>

#include "device_scene/accept_hit.h"
#include "trace/wide/trace_many.h"

namespace pertev {

/// Finds the closest hits of `count` rays: hits[i] is that of ray_of(i), among the candidates that accept_of(i)
/// accepts. `F` is the number type of packets.
template <class F = Floats8, class RayOf, class AcceptOf>
inline void find_hits(const HostTrees& trees, uint32_t count, RayOrder order, const RayOf& ray_of,
                      const AcceptOf& accept_of, Hit* hits) {
    trace_closest_many<TraversalOptions{}, F>(trees, count, order, ray_of, accept_of, hits);
}

/// Finds closest hits of camera or bounce rays. Culled backs do not count for camera rays (AcceptCameraHit).
template <class F = Floats8, class RayOf, class AcceptOf>
inline void find_hits(const HostTrees& trees, const SceneView& scene, bool from_camera, uint32_t count,
                      const RayOf& ray_of, const AcceptOf& accept_of, Hit* hits) {
    const RayOrder order = from_camera ? RayOrder::Together : RayOrder::Scattered;
    if (!from_camera || scene.any_hidden_back == 0) return find_hits<F>(trees, count, order, ray_of, accept_of, hits);
    const auto accept_camera = [&](uint32_t i) { return AcceptCameraHit{accept_of(i), ray_of(i).direction}; };
    find_hits<F>(trees, count, order, ray_of, accept_camera, hits);
}

/// Returns whether each of `count` rays hits anything.
template <class F = Floats8, class RayOf, class AcceptOf>
inline void find_occlusions(const HostTrees& trees, uint32_t count, RayOrder order, const RayOf& ray_of,
                            const AcceptOf& accept_of, bool* occluded) {
    // The builder's first child is the one where such searches usually end sooner. For rays without an end the
    // farthest is a better start (trace/trace_any.h).
    trace_any_many<TraversalOptions{.near_first = false}, F>(trees, count, order, ray_of, accept_of, occluded);
}

} // namespace pertev
