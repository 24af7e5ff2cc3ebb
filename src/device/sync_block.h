#pragma once

// The barrier of a block's threads, in kernels that run in whole blocks.

#include "base/host_device.h"

namespace pertev {

#if PERTEV_ON_DEVICE
/// Waits for all threads of the block. Those of a warp may have diverged: __syncthreads() takes them to be together,
/// and in the largest kernels of frames nvcc 13.0 leaves them apart, so that some pass too early (compute-sanitizer's
/// synccheck says "Divergent thread(s) in warp").
__device__ inline void sync_block() {
    __syncwarp();
    asm volatile("barrier.sync 0;" ::: "memory");
}
#endif

} // namespace pertev
