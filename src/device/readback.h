#pragma once

// A value that the host reads behind the work that makes it, while later work goes on: the host may look at what was
// some time ago and need not stop the device to see it.

#include <memory>
#include <type_traits>

#include "device/queue.h"

namespace pertev {

template <class T>
class Readback {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    /// `queue` outlives it.
    explicit Readback(Queue& queue) : queue_(&queue), copy_(queue.make_host_copy(sizeof(T))) {}

    /// Takes what lies at `device` once the work given to the current stream so far is done.
    void take(const T* device) { copy_->take(device); }
    /// In place of take(), without a copy between two kernels: a stage of the current stream writes the value there, at
    /// most once, when the one before has been waited for; mark() follows its launch.
    T* place() { return static_cast<T*>(copy_->place()); }
    void mark() { copy_->mark(); }
    /// What the last take() took, or the stage before the last mark() wrote, when it has. Throws Error(DeviceFault).
    T wait() { return *static_cast<const T*>(queue_->wait(*copy_)); }

private:
    Queue* queue_;
    std::unique_ptr<HostCopy> copy_;
};

} // namespace pertev
