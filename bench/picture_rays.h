#pragma once

// Traces rays as pictures do: in packets of the processor's widest lanes where rays go together, and otherwise in
// flight.

#include <span>

#include "trace/wide/trace_many.h"

namespace pertev {

inline constexpr TraversalOptions kClosest = {}, kAny = {.near_first = false}; // pictures' (device_scene/find_hits.h)

/// Rays and the result of each: hits of searches for the closest, `met` of those for any.
struct PictureRays {
    std::span<const Ray> rays;
    RayOrder order;
    bool any_hit;
    Hit* hits;
    bool* met;
};

void trace_as_pictures(const HostTrees& trees, const PictureRays& set);
#if defined(PERTEV_HAS_16_LANES)
/// Does the same by code for processors with AVX-512 (base/processor.h).
void trace_by_avx_512(const HostTrees& trees, const PictureRays& set);
#endif

/// The body of both; `F` is Floats8 or Floats16.
template <class F>
void trace_picture_rays(const HostTrees& trees, const PictureRays& set) {
    const auto count = static_cast<uint32_t>(set.rays.size());
    const auto ray_of = [&](uint32_t i) { return set.rays[i]; };
    const auto accept_of = [](uint32_t) { return AcceptAll{}; };
    if (set.any_hit) {
        trace_any_many<kAny, F>(trees, count, set.order, ray_of, accept_of, set.met);
    } else {
        trace_closest_many<kClosest, F>(trees, count, set.order, ray_of, accept_of, set.hits);
    }
}

} // namespace pertev
