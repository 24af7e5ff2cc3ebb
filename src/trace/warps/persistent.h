#pragma once

// Persistent threads: as many warps as the GPU holds at once, whose lanes take indices from one counter, together 32 at
// a time, until none is left. A stage runs as it does under launch() (device/launch.h); only who runs which index
// differs. Included by the .cu files that instantiate it, and by nothing else (see device/launch_body.h).
//
// Source: Aila, Laine, "Understanding the Efficiency of Ray Traversal on GPUs", HPG 2009, section 3.2.

#include <cstdint>

#include "base/error.h"
#include "base/host_device.h"
#include "device/queue.h"
#include "device/work_count.h"
#include "trace/warps/kernel_limits.h"

namespace pertev {

#if PERTEV_HAS_KERNELS

/// Each lane takes an index by itself: the compiler makes one addition of those of the lanes that are here. No lane
/// relies on another one: a warp's lanes may come back from a stage apart. ptxas 13.0 takes for granted that they meet
/// again, and leaves out the waiting of __syncwarp() and of the votes; but where it keeps a convergence barrier in a
/// register across a call (BMOV in SASS), they do not always. An index that lane 0 fetched for all was then read where
/// no lane 0 was, and the kernel did not end.
template <class Stage>
__global__ void __launch_bounds__(kWalkThreads) run_stage_persistent(Stage stage, WorkCount work, uint32_t* pool) {
    const uint32_t count = work.value();
    uint32_t i;
    do {
        i = atomicAdd(pool, 1u);
        if (i < count) stage(i);
    } while (!__all_sync(0xffffffffu, i >= count));
}

#endif

#if defined(__CUDACC__)

/// Runs stage(i) for each i in [0, count), count <= kMaxPoolCount. `pool` is one number in the queue's memory, 0
/// when the launch runs. The queue is of a GPU.
template <class Stage>
void launch_persistent(Queue& queue, const char* name, WorkCount count, const Stage& stage, uint32_t* pool) {
    PERTEV_CHECK(queue.is_cuda() && count.most <= kMaxPoolCount);
    if (count.most == 0) return;
    const Queue::Scope scope(queue, name);
    static LimitsByDevice limits;
    const uint32_t blocks = blocks_that_fit(limits.of(run_stage_persistent<Stage>), count.most, queue.streams());
    run_stage_persistent<<<blocks, kWalkThreads, 0, static_cast<cudaStream_t>(queue.stream())>>>(stage, count, pool);
    queue.check_launch();
}

#endif

} // namespace pertev
