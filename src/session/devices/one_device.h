#pragma once

// Helpers for code that runs on one of several devices.

#include "base/error.h"
#include "device/queue.h"

namespace pertev {

/// Returns whether an error is the device's own, so that the others can go on without it.
inline bool is_its_own(const Error& error) {
    return error.code() == ErrorCode::DeviceFault || error.code() == ErrorCode::OutOfMemory;
}

/// Makes another queue of the same device, with the same threads. Its work does not wait for that of `queue`.
inline Queue another_queue(const Queue& queue) {
    return queue.is_cuda() ? Queue::make_cuda(queue.device_index(), queue.threads()) : Queue::make_cpu(queue.threads());
}

} // namespace pertev
