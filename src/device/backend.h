#pragma once

// A kind of device must offer this: the few calls that move memory, wait and tell the time. There are the CPU
// (queue.cpp), CUDA (cuda/cuda_backend.cpp), and a dry run of either, which counts memory (queue.cpp); a queue calls
// through this table.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace pertev {

/// A moment in a queue's work.
class TimeMark {
public:
    virtual ~TimeMark() = default;
    /// The moment when all work given so far is done.
    virtual void record() = 0;
    /// Waits for both moments, which belong to one queue and have been recorded. Throws Error(DeviceFault).
    virtual double seconds_since(const TimeMark& earlier) const = 0;
};

/// A few bytes on their way from the device to the host, which goes on meanwhile.
class HostCopy {
public:
    virtual ~HostCopy() = default;
    /// Copies from `device` after the work given to the current stream so far. The bytes before have been waited for.
    virtual void take(const void* device) = 0;
    /// In place of take(): where a stage writes the bytes itself, then said once it has been given to the current
    /// stream.
    virtual void* place() = 0;
    virtual void mark() = 0;
    /// Waits for the last take() or mark() and for nothing behind it. The bytes stay until the next. Throws
    /// Error(DeviceFault) that names `stage`, the last one launched.
    virtual const void* wait(const char* stage) = 0;
};

class DeviceBackend {
public:
    virtual ~DeviceBackend() = default;

    /// From now on, what the calling thread asks of CUDA goes to this device. Each call below makes it so first; a
    /// launch goes through no call here, so Queue::Scope does. On the CPU it does nothing. Throws Error(DeviceFault).
    virtual void make_current() const = 0;

    virtual std::string name() const = 0;
    virtual bool is_cuda() const = 0;
    /// Returns whether the device only counts bytes (Queue::make_dry_run).
    virtual bool is_dry_run() const { return false; }
    virtual void* stream() const = 0; // the current one, a cudaStream_t; null on the CPU
    /// Later work goes to stream `index`. On the CPU there is but one.
    virtual void use_stream(int index) = 0;
    /// Stream `waiting` goes on after what stream `other` has been given so far.
    virtual void let_wait(int waiting, int other) = 0;
    virtual std::size_t free_bytes() const = 0;

    /// Null when there is not enough memory; throws Error(DeviceFault) for anything else.
    virtual void* allocate(std::size_t bytes) = 0;
    virtual void free(void* memory) noexcept = 0;
    virtual void copy_to_device(void* device, const void* host, std::size_t bytes) = 0;
    virtual void copy_to_host(void* host, const void* device, std::size_t bytes) = 0;
    /// In the stream's order.
    virtual void copy_on_device(void* to, const void* from, std::size_t bytes) = 0;
    virtual void fill(void* device, unsigned char value, std::size_t bytes) = 0;
    /// Waits for all work given to the current stream so far. Throws Error(DeviceFault) that names `stage`, the last
    /// one launched.
    virtual void wait(const char* stage) = 0;
    /// Throws Error(DeviceFault) when the launch just made was refused.
    virtual void check_launch(const char* stage) = 0;
    virtual std::unique_ptr<TimeMark> make_time_mark() = 0;
    virtual std::unique_ptr<HostCopy> make_host_copy(std::size_t bytes) = 0;
};

/// Why no CUDA device can be used, or empty when device `index` can: no support compiled in, no driver, no such
/// device, or an architecture that the binary holds no code for. The calling thread's device stays as it was.
std::string why_no_cuda(int index);
/// Whether there may be one: whether a driver's library is there. That is known at once; CUDA's first answer takes a
/// tenth of a second, and a started driver a quarter.
bool may_have_cuda();
int cuda_device_count();
/// Throws Error(BadInput) with why_no_cuda's reason.
std::unique_ptr<DeviceBackend> make_cuda_backend(int index);

} // namespace pertev
