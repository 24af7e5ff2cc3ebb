#pragma once

// Counters of loops that call functions on the device.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

/// Returns `value`, as a number of each thread alone; `of_thread` is any number that differs between threads and is not
/// NaN. A loop of equally many rounds for all threads that calls functions begins its counter with this. nvcc 13.0
/// keeps such a counter in one register for the whole warp otherwise, because the threads meet at the end of each
/// round; but after calls in nested branches some of them do not, and each group then counts for all, so that rounds
/// are left out. tools/check_warp_counters.py finds such loops in compiled kernels.
HD inline uint32_t per_thread(uint32_t value, float of_thread) {
    return of_thread <= of_thread ? value : ~0u; // no compiler may leave out this comparison
}

} // namespace pertev
