#pragma once

// Bodies of host_shading.h for the files that compile them, one per kind of listeners.

// Functions of stacks of layers are called here, as in device code. Inlined, they take g++ three times as long, and
// pictures no less time.

#include "base/host_device.h"

#if !defined(__CUDACC__)
#undef HD_CALL
#define HD_CALL [[gnu::noinline]]
#endif

#include <type_traits>

#include "base/error.h"
#include "integrators/path/compiled_features.h"
#include "integrators/path/host_shading.h"
#include "integrators/path/path_code.h"

namespace pertev {

template <Features kFeatures, class Listener>
inline bool shade_on_host(const PathJob& job, PathState& path, typename Listener::PathData& kept, const Hit& hit,
                          const DrawnNumbers& numbers, VertexShadow<Listener> shadow, bool& goes_on) {
    Listener listener(job);
    if (path.depth == 0) {
        listener.begins(path);
    } else {
        listener.restore(kept);
    }
    bool has_shadow_ray = false;
    goes_on = shade_vertex<kFeatures>(job, path, hit, numbers, shadow.ray, has_shadow_ray, listener);
    listener.save(kept);
    if (has_shadow_ray) listener.save_shadow_data(shadow.data);
    return has_shadow_ray;
}

/// Returns whether code for a mask of features is inlined as a whole. By default g++ would leave a dozen calls, which
/// takes a third more time in Bitterli's box. Inlining takes g++ up to twenty times as long, so rare code (layers,
/// motion, frames of other than diffuse materials) and builds that only test (src/CMakeLists.txt) do without.
template <class Listener>
constexpr bool is_flattened([[maybe_unused]] Features features) {
#if defined(PERTEV_KEEPS_CALLS)
    return false;
#else
    return (features & kMoving) == 0 && (std::is_same_v<Listener, FilmListeners> || (features & kLayered) == 0);
#endif
}

template <Features kFeatures, class Listener>
[[gnu::flatten]] bool shade_flattened(const PathJob& job, PathState& path, typename Listener::PathData& kept,
                                      const Hit& hit, const DrawnNumbers& numbers, VertexShadow<Listener> shadow,
                                      bool& goes_on) {
    return shade_on_host<kFeatures, Listener>(job, path, kept, hit, numbers, shadow, goes_on);
}

template <class Listener, class Compiled>
ShadeOnHost<Listener> choose_shading_on_host(const PathJob& job) {
    ShadeOnHost<Listener> shading = nullptr;
    PERTEV_CHECK(Compiled::choose(features_for(job) & ~kBatched, [&]<Features kMask>() {
        constexpr Features kFeatures = kMask | kBatched; // batches by the same code, because a host has the registers
        if constexpr (is_flattened<Listener>(kFeatures)) {
            shading = shade_flattened<kFeatures, Listener>;
        } else {
            shading = shade_on_host<kFeatures, Listener>;
        }
    }));
    return shading;
}

} // namespace pertev
