#pragma once

// Counting sorts by small keys, so that the threads of a warp run the same code: of a block's indices in shared memory,
// and of all indices of a launch.

#include <cstdint>

#include "base/host_device.h"
#include "device/atomics.h"
#include "device/sync_block.h"

namespace pertev {

/// Number of keys, [0, kBlockKeys).
inline constexpr uint32_t kBlockKeys = 32;

/// Returns the index that the thread with index `i` takes if the indices of its block of kThreads threads are sorted by
/// their `key`. On the device all threads of the block must call it, at most once; elsewhere it returns `i`. Indices of
/// the largest key come last.
template <int kThreads>
HD inline uint32_t sorted_in_block(uint32_t i, [[maybe_unused]] uint32_t key) {
#if PERTEV_ON_DEVICE
    __shared__ uint32_t starts[kBlockKeys]; // counts at first
    __shared__ uint16_t order[kThreads];
    if (threadIdx.x < kBlockKeys) starts[threadIdx.x] = 0;
    sync_block();
    const uint32_t rank = atomicAdd(starts + key, 1u);
    sync_block();
    if (threadIdx.x < kBlockKeys) { // prefix sums, in one warp
        const uint32_t count = starts[threadIdx.x];
        uint32_t sum = count;
        for (uint32_t step = 1; step < kBlockKeys; step *= 2) {
            const uint32_t before = __shfl_up_sync(0xffffffffu, sum, step);
            if (threadIdx.x >= step) sum += before;
        }
        starts[threadIdx.x] = sum - count;
    }
    sync_block();
    order[starts[key] + rank] = static_cast<uint16_t>(threadIdx.x);
    sync_block();
    return i - threadIdx.x + order[threadIdx.x];
#else
    return i;
#endif
}

/// Returns the slot of the thread's element in the list of its `key`, for a thread that `adds` one, and increases
/// sizes[key]: a block makes one atomic addition for each of its keys. On the device all threads of the block must call
/// it, at most once.
HD inline uint32_t append_by_key(uint32_t* sizes, uint32_t key, bool adds) {
#if PERTEV_ON_DEVICE
    __shared__ uint32_t counts[kBlockKeys];
    if (threadIdx.x < kBlockKeys) counts[threadIdx.x] = 0;
    sync_block();
    const uint32_t rank = adds ? atomicAdd(counts + key, 1u) : 0u;
    sync_block();
    if (threadIdx.x < kBlockKeys) {
        const uint32_t count = counts[threadIdx.x];
        counts[threadIdx.x] = count > 0 ? atomicAdd(sizes + threadIdx.x, count) : 0u;
    }
    sync_block();
    return counts[key] + rank;
#else
    return adds ? atomic_add(sizes + key, 1u) : 0u;
#endif
}

} // namespace pertev
