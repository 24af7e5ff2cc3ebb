#pragma once

// Waits for the work of others on a queue's device, such as kernels of PyTorch that read an array which Pertev fills
// again. The queue's own streams are not ordered with streams of other programs.

#include "device/queue.h"

namespace pertev {

/// Waits for all work on the device of `queue`, by all streams of this process. Does nothing on the CPU. Throws
/// Error(DeviceFault).
void wait_for_device(const Queue& queue);

} // namespace pertev
