#pragma once

// Runs one piece of work per index, on whichever device the queue belongs to. A "stage" is a plain struct of views and
// numbers with `HD void operator()(uint32_t i) const`. Each stage has one .cu file that instantiates this (through
// device/launch_body.h); without CUDA that file is compiled as C++.
//
// Where threads of a block work together (device/list_places.h) a stage has `HD void operator()(uint32_t i, bool
// is_there) const` in place of that, which whole blocks run: `is_there` is false beyond the last index. It says which
// blocks by `static constexpr BlockShape kShape`.

#include <cstdint>

#include "device/queue.h"
#include "device/work_count.h"

namespace pertev {

/// How a GPU runs a stage whose whole blocks come together.
struct BlockShape {
    int threads; // a block, a multiple of 32
    int wanted;  // blocks that a multiprocessor is to hold, though registers spill
};

/// Whether it is such a stage.
template <class Stage>
concept WholeBlockStage = requires(const Stage& stage) { stage(uint32_t{}, bool{}); };

/// Runs stage(i) for each i in [0, count), in no stated order, after all work given to the stream before. `name` shows
/// in errors. Throws Error(DeviceFault) when the launch is refused; a fault inside the stage is thrown by the next
/// queue.wait(), with this name. On the CPU it returns when done.
template <class Stage>
void launch(Queue& queue, const char* name, WorkCount count, const Stage& stage);

} // namespace pertev
