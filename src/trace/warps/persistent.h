#pragma once

// Persistent threads: as many warps as the GPU holds at once, whose lanes fetch indices from one counter until none
// is left. A stage runs as under launch() (device/launch.h); only the assignment of indices to threads differs. Only
// .cu files that instantiate it include this (device/launch_body.h).
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

/// Runs a stage by lanes that each fetch their next index; the compiler combines the additions of converged lanes. No
/// lane relies on another one, because a warp's lanes may return from a stage diverged. ptxas 13.0 assumes that they
/// reconverge and omits the waiting of __syncwarp() and of the votes, but where it keeps a convergence barrier in a
/// register across a call (BMOV in SASS), they do not always. An index that lane 0 fetched for all was then read where
/// there was no lane 0, and the kernel did not end.
template <class Stage>
__global__ void __launch_bounds__(kTraversalThreads) run_stage_persistent(Stage stage, WorkCount work, uint32_t* pool) {
    const uint32_t count = work.value();
    uint32_t i;
    do {
        i = atomicAdd(pool, 1u);
        if (i < count) stage(i);
    } while (!__all_sync(0xffffffffu, i >= count));
}

#endif

#if defined(__CUDACC__)

/// Runs stage(i) for each i in [0, count), count <= kMaxPoolCount. `pool` is a counter in the queue's memory, 0 when
/// the launch runs. The queue is a GPU's.
template <class Stage>
void launch_persistent(Queue& queue, const char* name, WorkCount count, const Stage& stage, uint32_t* pool) {
    PERTEV_CHECK(queue.is_cuda() && count.most <= kMaxPoolCount);
    if (count.most == 0) return;
    const Queue::Scope scope(queue, name);
    static LimitsByDevice limits;
    const uint32_t blocks = blocks_that_fit(limits.of(run_stage_persistent<Stage>), count.most, queue.streams());
    run_stage_persistent<<<blocks, kTraversalThreads, 0, static_cast<cudaStream_t>(queue.stream())>>>(stage, count,
                                                                                                      pool);
    queue.check_launch();
}

#endif

} // namespace pertev
