#pragma once

// Persistent threads: as many warps as the GPU holds at once, each of which takes 32 indices at a time from one counter
// until none is left. A stage runs as it does under launch() (device/launch.h); only who runs which index differs.
// Included by the .cu files that instantiate it, and by nothing else (see device/launch_body.h).
//
// Source: Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009, section 3.2 (one lane fetches
// for its warp).

#include <cstdint>

#include "base/error.h"
#include "base/host_device.h"
#include "device/queue.h"
#include "device/work_count.h"
#include "trace/warps/kernel_limits.h"

namespace pertev {

#if PERTEV_HAS_KERNELS

/// The next `wanted` indices of a pool, for the warp whose lanes are all here: the first of them.
__device__ inline uint32_t fetch_from_pool(uint32_t* pool, uint32_t wanted) {
    uint32_t first = 0;
    if (threadIdx.x % 32 == 0) first = atomicAdd(pool, wanted);
    return __shfl_sync(0xffffffffu, first, 0);
}

template <class Stage>
__global__ void __launch_bounds__(kWalkThreads) run_stage_persistent(Stage stage, WorkCount work, uint32_t* pool) {
    const uint32_t count = work.value();
    for (;;) {
        const uint32_t first = fetch_from_pool(pool, 32);
        if (first >= count) return;
        const uint32_t i = first + threadIdx.x % 32;
        if (i < count) stage(i);
        __syncwarp();
    }
}

#endif

#if defined(__CUDACC__)

/// Runs stage(i) for each i in [0, count), count <= kMaxPoolCount. `pool` is one number in the queue's memory; it is
/// set to 0 first. The queue is of a GPU.
template <class Stage>
void launch_persistent(Queue& queue, const char* name, WorkCount count, const Stage& stage, uint32_t* pool) {
    PERTEV_CHECK(queue.is_cuda() && count.most <= kMaxPoolCount);
    if (count.most == 0) return;
    const Queue::Scope scope(queue, name);
    static LimitsByDevice limits;
    const uint32_t blocks = blocks_that_fit(limits.of(run_stage_persistent<Stage>), count.most, queue.streams());
    queue.zero(pool, sizeof *pool);
    run_stage_persistent<<<blocks, kWalkThreads, 0, static_cast<cudaStream_t>(queue.stream())>>>(stage, count, pool);
    queue.check_launch();
}

#endif

} // namespace pertev
