#pragma once

// Votes among the lanes of a warp. On the host a warp is one ray. Which lanes run together depends on timing, so a
// vote may affect the amount and order of work, but never the result.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

using LaneMask = uint32_t; // bit k stands for lane k

/// The mask of the lanes that execute this line together.
HD inline LaneMask lanes_here() {
#if PERTEV_ON_DEVICE
    return __activemask();
#else
    return 1;
#endif
}

/// Returns whether the condition holds for all lanes that execute this line together.
HD inline bool all_lanes_here(bool mine) {
#if PERTEV_ON_DEVICE
    return __all_sync(__activemask(), mine) != 0;
#else
    return mine;
#endif
}

/// Mask of the lanes with the same key as this one, among `lanes`, all of which must call it.
HD inline LaneMask lanes_with_same(LaneMask lanes, uint64_t key) {
#if PERTEV_ON_DEVICE
    return __match_any_sync(lanes, static_cast<unsigned long long>(key));
#else
    static_cast<void>(key);
    return lanes;
#endif
}

/// Returns whether this lane is the first of `lanes`, which include it.
HD inline bool is_first_lane(LaneMask lanes) {
#if PERTEV_ON_DEVICE
    return static_cast<unsigned>(__ffs(static_cast<int>(lanes)) - 1) ==
           (threadIdx.x & 31u); // blocks are one-dimensional
#else
    return lanes != 0;
#endif
}

/// Mask of the lanes with a true condition. All of `lanes` must call it, and wait for each other.
HD inline LaneMask ballot(LaneMask lanes, bool mine) {
#if PERTEV_ON_DEVICE
    return __ballot_sync(lanes, mine);
#else
    return lanes & (mine ? 1u : 0u);
#endif
}

/// Mask of the lanes of the warp before this one. It is queried from the hardware each time, because storing it would
/// take a register.
HD inline LaneMask lanes_before() {
#if defined(PERTEV_EMULATED_WARPS)
    return emulated_lanes_before();
#elif PERTEV_ON_DEVICE
    LaneMask lanes;
    asm volatile("mov.u32 %0, %%lanemask_lt;" : "=r"(lanes));
    return lanes;
#else
    return 0;
#endif
}

HD inline int count_lanes(LaneMask lanes) {
#if PERTEV_ON_DEVICE
    return __popc(lanes);
#else
    return __builtin_popcount(lanes);
#endif
}

} // namespace pertev
