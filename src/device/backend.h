#pragma once

// The interface of a kind of device: a few calls that manage memory, wait and measure time. There are the CPU
// (queue.cpp), CUDA (cuda/cuda_backend.cpp), and a dry run of either, which counts memory (queue.cpp).

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace pertev {

/// A time stamp in a queue's work.
class TimeMark {
public:
    virtual ~TimeMark() = default;
    /// Records the time when all work queued so far is done.
    virtual void record() = 0;
    /// Returns the seconds from `earlier` to this time stamp, after waiting for both. They belong to one queue and have
    /// been recorded. Throws Error(DeviceFault).
    virtual double seconds_since(const TimeMark& earlier) const = 0;
};

/// An asynchronous copy of a few bytes from the device to the host.
class HostCopy {
public:
    virtual ~HostCopy() = default;
    /// Copies from `device` after the work queued on the current stream so far. The previous copy must have been
    /// waited for.
    virtual void take(const void* device) = 0;
    /// Alternative to take(): the address to which a stage writes the bytes itself. mark() must follow its launch on
    /// the current stream.
    virtual void* target() = 0;
    virtual void mark() = 0;
    /// Waits for the last take() or mark(), and not for later work. The bytes stay until the next one. Throws
    /// Error(DeviceFault) that names `stage`, the last one launched.
    virtual const void* wait(const char* stage) = 0;
};

class DeviceBackend {
public:
    virtual ~DeviceBackend() = default;

    /// Makes this device CUDA's current one for the calling thread. Each call below does so first; a launch makes no
    /// call here, so Queue::Scope does. Does nothing on the CPU. Throws Error(DeviceFault).
    virtual void make_current() const = 0;

    virtual std::string name() const = 0;
    virtual bool is_cuda() const = 0;
    /// Returns whether the device only counts bytes (Queue::make_dry_run).
    virtual bool is_dry_run() const { return false; }
    virtual int index() const { return 0; } // the CUDA device's
    virtual void* stream() const = 0;       // the current one, a cudaStream_t; null on the CPU
    /// Directs later work to stream `index`. The CPU has only one.
    virtual void use_stream(int index) = 0;
    /// Makes stream `waiting` wait for the work queued on stream `other` so far.
    virtual void make_stream_wait(int waiting, int other) = 0;
    virtual std::size_t free_bytes() const = 0;

    /// Allocates device memory. Returns null if there is not enough; throws Error(DeviceFault) for any other failure.
    virtual void* allocate(std::size_t bytes) = 0;
    virtual void free(void* memory) noexcept = 0;
    virtual void copy_to_device(void* device, const void* host, std::size_t bytes) = 0;
    virtual void copy_to_host(void* host, const void* device, std::size_t bytes) = 0;
    /// Copies device memory to device memory, in the stream's order.
    virtual void copy_on_device(void* to, const void* from, std::size_t bytes) = 0;
    virtual void fill(void* device, unsigned char value, std::size_t bytes) = 0;
    /// Waits for all work queued on the current stream so far. Throws Error(DeviceFault) that names `stage`, the last
    /// one launched.
    virtual void wait(const char* stage) = 0;
    /// Throws Error(DeviceFault) if the last launch was refused.
    virtual void check_launch(const char* stage) = 0;
    virtual std::unique_ptr<TimeMark> make_time_mark() = 0;
    virtual std::unique_ptr<HostCopy> make_host_copy(std::size_t bytes) = 0;
};

/// Returns why CUDA device `index` cannot be used, or empty if it can: no support compiled in, no driver, no such
/// device, or an architecture for which the binary has no code. The calling thread's device does not change.
std::string why_no_cuda(int index);
/// Returns whether there may be a CUDA device, that is, a driver library. The answer is immediate, while the first CUDA
/// call takes a tenth of a second, and starting a driver a quarter.
bool may_have_cuda();
int cuda_device_count();
/// A CUDA device, for a list of them.
struct CudaDevice {
    std::string name;
    int major = 0, minor = 0; // compute capability
    std::size_t bytes = 0;    // memory
};
std::vector<CudaDevice> cuda_devices();
/// Makes the backend of CUDA device `index`. Throws Error(BadInput) with the reason of why_no_cuda.
std::unique_ptr<DeviceBackend> make_cuda_backend(int index);

} // namespace pertev
