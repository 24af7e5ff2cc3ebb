#pragma once

// Bodies of host_shading.h for the files that compile them, one per kind of listeners.

#include "base/error.h"
#include "integrators/path/host_shading.h"

namespace pertev {
#if defined(PERTEV_KEEPS_CALLS)
#define PERTEV_INLINE_ALL
#else
#define PERTEV_INLINE_ALL [[gnu::flatten]]
#endif

/// Everything it calls is inlined. By default g++ would leave a dozen calls, which takes a third more time in
/// Bitterli's box. Inlining takes g++ twenty times as long, so builds that only test (src/CMakeLists.txt) do without.
template <Features kFeatures, class Listener>
PERTEV_INLINE_ALL bool shade_on_host(const PathJob& job, PathState& path, typename Listener::Kept& kept, const Hit& hit,
                                     const DrawnNumbers& numbers, VertexShadowRay<Listener>& shadow_data,
                                     bool& goes_on) {
    Listener listener(job);
    if (path.depth == 0) {
        listener.begins(path);
    } else {
        listener.take_up(kept);
    }
    bool wants_shadow = false;
    goes_on = shade_vertex<kFeatures>(job, path, hit, numbers, shadow_data.ray, wants_shadow, listener);
    listener.put_down(kept);
    if (wants_shadow) listener.hand_over(shadow_data.shadow_data);
    return wants_shadow;
}

template <class Listener, class Compiled>
ShadeOnHost<Listener> choose_shading_on_host(const PathJob& job) {
    ShadeOnHost<Listener> shading = nullptr;
    PERTEV_CHECK(Compiled::choose(features_for(job),
                                  [&]<Features kFeatures>() { shading = shade_on_host<kFeatures, Listener>; }));
    return shading;
}

} // namespace pertev
