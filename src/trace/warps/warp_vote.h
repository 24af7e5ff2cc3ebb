#pragma once

// Votes among the lanes of a warp. On the host a warp is one ray. Which lanes run together is a matter of timing, so a
// vote may decide how much work is done and in which order, never what comes out.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

using LaneMask = uint32_t; // bit k: lane k

/// The lanes that run this line at this moment.
HD inline LaneMask lanes_here() {
#if PERTEV_ON_DEVICE
    return __activemask();
#else
    return 1;
#endif
}

/// Whether it holds for all lanes that run this line at this moment.
HD inline bool all_lanes_here(bool mine) {
#if PERTEV_ON_DEVICE
    return __all_sync(__activemask(), mine) != 0;
#else
    return mine;
#endif
}

/// Those of `lanes`, all of which come here, that have the same key as this one.
HD inline LaneMask lanes_with_same(LaneMask lanes, uint64_t key) {
#if PERTEV_ON_DEVICE
    return __match_any_sync(lanes, static_cast<unsigned long long>(key));
#else
    static_cast<void>(key);
    return lanes;
#endif
}

/// Whether this lane is the first of `lanes`, one of which it is.
HD inline bool is_first_lane(LaneMask lanes) {
#if PERTEV_ON_DEVICE
    return static_cast<unsigned>(__ffs(static_cast<int>(lanes)) - 1) ==
           (threadIdx.x & 31u); // blocks are lines of threads
#else
    return lanes != 0;
#endif
}

/// Which of `lanes` say yes. All of them come here, and wait for each other.
HD inline LaneMask ballot(LaneMask lanes, bool mine) {
#if PERTEV_ON_DEVICE
    return __ballot_sync(lanes, mine);
#else
    return lanes & (mine ? 1u : 0u);
#endif
}

/// The lanes of the warp before this one. Asked of the hardware each time: kept, it would take a register.
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
