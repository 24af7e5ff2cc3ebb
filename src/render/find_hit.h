#pragma once

// What one ray meets, for loops over rays on the host: by the walk of eight boxes at a time, with the same rules of
// what counts as the tracers of queues have (render/accept_queued.h).

#include <cstdint>

#include "render/accept_hit.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"
#include "trace/wide/walk_wide.h"

namespace pertev {

template <class Accept>
[[gnu::always_inline]] inline Hit find_hit(const HostTrees& trees, const Ray& ray, const Accept& accept) {
    Hit hit;
    trace_closest<Wide8SimdWalk<WalkOptions{}>>(trees, ray, accept, hit);
    return hit;
}

template <class Accept>
[[gnu::always_inline]] inline bool is_occluded(const HostTrees& trees, const Ray& ray, const Accept& accept) {
    // Of several children, the builder put first where such searches end sooner.
    return trace_any<Wide8SimdWalk<WalkOptions{.near_first = false}>>(trees, ray, accept);
}

} // namespace pertev
