#pragma once

// The body of launch(), included only by the .cu files that instantiate stages. A .cpp that included it would make a
// second, CPU-only copy of the same weak symbol, and the linker may choose that one.

#include "base/host_device.h"
#include "base/parallel_for.h"
#include "device/launch.h"

namespace pertev {

#if PERTEV_HAS_KERNELS
/// A stage's functions that are called, not inlined, take its members by reference. Without __grid_constant__ each
/// thread would copy the stage for them into its own memory, and all pointers in it would be of unknown memory.
template <class Stage>
__global__ void __launch_bounds__(128) run_stage(const __grid_constant__ Stage stage, const WorkCount count) {
    // 64-bit on purpose: blocks * threads passes 2^32 for large queues.
    const uint64_t i = uint64_t(blockIdx.x) * blockDim.x + threadIdx.x;
    if (i < count.value()) stage(uint32_t(i));
}

template <class Stage>
__global__ void __launch_bounds__(Stage::kShape.threads, Stage::kShape.wanted)
    run_whole_blocks(const __grid_constant__ Stage stage, const WorkCount count) {
    // Not in a function of its own: one that is not inlined reads the stage as any memory, not as constants.
    const uint64_t first = uint64_t(blockIdx.x) * blockDim.x, i = first + threadIdx.x;
    const uint32_t indices = count.value();
    if (first < indices) stage(uint32_t(i), i < indices);
}
#endif

#if defined(__CUDACC__)
/// Launches on a GPU's queue only, so that the CPU's loop is not compiled.
template <class Stage>
void launch_on_gpu(Queue& queue, const char* name, WorkCount count, const Stage& stage) {
    if (count.most == 0 || queue.is_dry_run()) return;
    const Queue::Scope scope(queue, name);
    const auto stream = static_cast<cudaStream_t>(queue.stream());
    const auto blocks_of = [&](uint64_t threads) { return uint32_t((uint64_t(count.most) + threads - 1) / threads); };
    if constexpr (WholeBlockStage<Stage>) {
        constexpr uint32_t threads = Stage::kShape.threads;
        run_whole_blocks<<<blocks_of(threads), threads, 0, stream>>>(stage, count);
    } else {
        constexpr uint32_t threads = 128;
        run_stage<<<blocks_of(threads), threads, 0, stream>>>(stage, count);
    }
    queue.check_launch();
}
#endif

template <class Stage>
void launch(Queue& queue, const char* name, WorkCount count, const Stage& stage) {
#if defined(__CUDACC__)
    if (queue.is_cuda()) return launch_on_gpu(queue, name, count, stage);
#endif
    if (count.most == 0 || queue.is_dry_run()) return;
    const Queue::Scope scope(queue, name);
    const UseThreads use(queue.threads());
    parallel_for(count.value(), host_grain<Stage>(), [&](uint64_t i) {
        if constexpr (WholeBlockStage<Stage>) {
            stage(static_cast<uint32_t>(i), true);
        } else {
            stage(static_cast<uint32_t>(i));
        }
    });
}

} // namespace pertev
