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
    /// What the last take() took, when it has. Throws Error(DeviceFault).
    T wait() { return *static_cast<const T*>(queue_->wait(*copy_)); }

private:
    Queue* queue_;
    std::unique_ptr<HostCopy> copy_;
};

} // namespace pertev
