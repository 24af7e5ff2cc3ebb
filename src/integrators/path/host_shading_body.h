#pragma once

// Bodies of host_shading.h, for the files that compile them: one a kind of listeners.

#include "base/error.h"
#include "integrators/path/host_shading.h"

namespace pertev {
#if defined(PERTEV_KEEPS_CALLS)
#define PERTEV_INLINE_ALL
#else
#define PERTEV_INLINE_ALL [[gnu::flatten]]
#endif

/// All that it calls is in line: g++ by itself would leave a dozen calls, for a third more time of Bitterli's box. That
/// takes g++ twenty times as long, so that a build that only tests (src/CMakeLists.txt) does without.
template <Features kFeatures, class Listener>
PERTEV_INLINE_ALL bool shade_on_host(const PathJob& job, PathState& path, typename Listener::Kept& kept, const Hit& hit,
                                     const DrawnNumbers& numbers, AskedByVertex<Listener>& asked, bool& goes_on) {
    Listener listener(job);
    if (path.depth == 0) {
        listener.begins(path);
    } else {
        listener.take_up(kept);
    }
    bool wants_shadow = false;
    goes_on = shade_vertex<kFeatures>(job, path, hit, numbers, asked.ray, wants_shadow, listener);
    listener.put_down(kept);
    if (wants_shadow) listener.hand_over(asked.asked);
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
