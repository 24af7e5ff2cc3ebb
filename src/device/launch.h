#pragma once

// Runs a stage once per index on the queue's device. A "stage" is a plain struct of views and numbers with `HD void
// operator()(uint32_t i) const`. Each stage has one .cu file that instantiates this (src/instances.cmake);
// without CUDA that file is compiled as C++.
//
// A stage whose threads cooperate within a block (device/block_append.h) has `HD void operator()(uint32_t i, bool
// is_there) const` instead, which runs in whole blocks: `is_there` is false beyond the last index. It sets the block
// size by `static constexpr BlockShape kShape`.

#include <cstdint>

#include "device/queue.h"
#include "device/work_count.h"

namespace pertev {

/// Launch parameters of a stage that runs in whole blocks.
struct BlockShape {
    int threads; // per block, a multiple of 32
    int wanted;  // blocks per multiprocessor, even if registers spill
};

/// A stage that runs in whole blocks.
template <class Stage>
concept WholeBlockStage = requires(const Stage& stage) { stage(uint32_t{}, bool{}); };

/// The least number of consecutive indices of `Stage` that a CPU thread runs. A stage whose calls are so cheap that
/// waking a second thread for 256 of them takes longer than they do sets kHostGrain.
template <class Stage>
constexpr uint32_t host_grain() {
    if constexpr (requires { Stage::kHostGrain; }) return Stage::kHostGrain;
    return 256;
}

/// Runs stage(i) for each i in [0, count), in no fixed order, after all work queued on the stream before. `name`
/// appears in errors. Throws Error(DeviceFault) if the launch is refused; a fault inside the stage is thrown by the
/// next queue.wait(), with this name. On the CPU it returns when done.
template <class Stage>
void launch(Queue& queue, const char* name, WorkCount count, const Stage& stage);

} // namespace pertev
