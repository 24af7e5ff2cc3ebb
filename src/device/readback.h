#pragma once

// An asynchronous readback of a value: the host reads it after the work that makes it, while later work continues,
// without stopping the device.

#include <memory>
#include <type_traits>

#include "device/queue.h"

namespace pertev {

template <class T>
class Readback {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    /// `queue` must outlive this object.
    explicit Readback(Queue& queue) : queue_(&queue), copy_(queue.make_host_copy(sizeof(T))) {}

    /// Copies the value at `device` once the work queued on the current stream so far is done.
    void take(const T* device) { copy_->take(device); }
    /// Alternative to take() without a copy between two kernels: a stage of the current stream writes the value
    /// there, at most once, after the previous one has been waited for; mark() follows its launch.
    T* target() { return static_cast<T*>(copy_->target()); }
    void mark() { copy_->mark(); }
    /// Waits for the value of the last take(), or of the stage before the last mark(). Throws Error(DeviceFault).
    T wait() { return *static_cast<const T*>(queue_->wait(*copy_)); }

private:
    Queue* queue_;
    std::unique_ptr<HostCopy> copy_;
};

} // namespace pertev
