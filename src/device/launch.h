#pragma once

// Runs one piece of work per index, on whichever device the queue belongs to. A "stage" is a plain struct of views and
// numbers with `HD void operator()(uint32_t i) const`. Each stage has one .cu file that instantiates this (through
// device/launch_body.h); without CUDA that file is compiled as C++.

#include <cstdint>

#include "device/queue.h"
#include "device/work_count.h"

namespace pertev {

/// Runs stage(i) for each i in [0, count), in no stated order, after all work given to the stream before. `name` shows
/// in errors. Throws Error(DeviceFault) when the launch is refused; a fault inside the stage is thrown by the next
/// queue.wait(), with this name. On the CPU it returns when done.
template <class Stage>
void launch(Queue& queue, const char* name, WorkCount count, const Stage& stage);

} // namespace pertev
