#pragma once

// A queue of work on one device, and the owner of that device's memory. Work runs in order. On the CPU each call
// returns when it is done; in CUDA it runs asynchronously, and wait() synchronizes. Several queues, on one device or
// on many, may be used alternately from one thread or concurrently from several; a queue is for one thread at a time.
//
// While a Queue::Fork exists, a queue has several streams of work: each runs in order, and on a GPU they run
// concurrently, so that one uses what another leaves idle.

#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>
#include <string>
#include <vector>

#include "base/parallel_for.h"
#include "device/backend.h"

namespace pertev {

class Queue {
public:
    /// Returns a queue of the CPU, whose work these threads do.
    static Queue make_cpu(const Threads& threads = {});
    /// Returns a queue of CUDA device `index`; the threads do the host's part. Throws Error(BadInput) with the reason
    /// if the device cannot be used.
    static Queue make_cuda(int index, const Threads& threads = {});
    /// Returns a queue that counts the bytes of buffers and allocates no memory. Nothing may read a buffer's address,
    /// and nothing is copied, filled or launched. The count predicts the memory of the same code on a device.
    static Queue make_dry_run(bool is_cuda);
    /// Moves a queue that has not allocated memory; later its buffers would point to the old one.
    Queue(Queue&& other);

    /// The threads that do the host's work for the queue, whichever thread uses it.
    const Threads& threads() const { return threads_; }
    bool is_cuda() const { return backend_->is_cuda(); }
    bool is_dry_run() const { return backend_->is_dry_run(); }
    /// Index of a CUDA device.
    int device_index() const { return backend_->index(); }
    void* stream() const { return backend_->stream(); }

    static constexpr int kMaxStreams = 4;
    int stream_index() const { return stream_index_; }
    /// Runs streams [0, count), count <= kMaxStreams, concurrently after all work queued so far. When the Fork ends,
    /// by an exception too, stream 0 continues alone, after all work of the others. There may be one at a time.
    class Fork {
    public:
        Fork(Queue& queue, int count) : queue_(queue) { queue.fork_streams(count); }
        ~Fork() {
            try {
                queue_.join_streams();
            } catch (const std::exception&) { // the device is lost, which the next wait() reports
                queue_.streams_ = 1;
            }
        }
        Fork(const Fork&) = delete;
        Fork& operator=(const Fork&) = delete;

    private:
        Queue& queue_;
    };
    /// Makes stream `waiting` wait for the work queued on stream `other` so far.
    void make_stream_wait(int waiting, int other) { backend_->make_stream_wait(waiting, other); }
    /// Number of concurrent streams.
    int streams() const { return streams_; }
    /// While it exists, launches, fills and waits use stream `index`. The only copy allowed is a Readback; uploads and
    /// downloads belong before the fork or after the join.
    class OnStream {
    public:
        OnStream(Queue& queue, int index) : queue_(queue) { queue.use_stream(index); }
        ~OnStream() { queue_.use_stream(0); }
        OnStream(const OnStream&) = delete;
        OnStream& operator=(const OnStream&) = delete;

    private:
        Queue& queue_;
    };
    std::string device_name() const { return backend_->name(); }

    /// Waits for all work queued on the stream. Throws Error(DeviceFault) that names the last stage launched if one
    /// failed.
    void wait() { backend_->wait(stage_); }
    void check_launch() { backend_->check_launch(stage_); }
    const void* wait(HostCopy& copy) { return copy.wait(stage_); }

    /// Makes a time stamp for device/device_timer.h.
    std::unique_ptr<TimeMark> make_time_mark() { return backend_->make_time_mark(); }
    std::unique_ptr<HostCopy> make_host_copy(std::size_t bytes) { return backend_->make_host_copy(bytes); }

    /// Allocates device memory, never null for bytes > 0. Throws Error(OutOfMemory) that lists the largest buffers.
    void* allocate(std::size_t bytes, const std::string& name);
    void free(void* memory) noexcept;
    void copy_to_device(void* device, const void* host, std::size_t bytes) {
        uploaded_ += bytes;
        backend_->copy_to_device(device, host, bytes);
    }
    void copy_to_host(void* host, const void* device, std::size_t bytes) {
        backend_->copy_to_host(host, device, bytes);
    }
    /// Copies device memory to device memory, in the stream's order.
    void copy_on_device(void* to, const void* from, std::size_t bytes) { backend_->copy_on_device(to, from, bytes); }
    void zero(void* device, std::size_t bytes) { backend_->fill(device, 0, bytes); }
    /// Sets every byte to `value`, in the stream's order.
    void fill(void* device, unsigned char value, std::size_t bytes) { backend_->fill(device, value, bytes); }

    std::size_t allocated_bytes() const { return allocated_; }
    std::size_t peak_bytes() const { return peak_; }
    /// Number of allocations since the queue was made.
    uint64_t allocation_count() const { return allocation_count_; }
    uint64_t uploaded_bytes() const { return uploaded_; }
    std::size_t free_bytes() const { return backend_->free_bytes(); }

    /// The scope of a launch. It names the stage for errors, and makes the queue's device the thread's current one.
    class Scope {
    public:
        Scope(Queue& queue, const char* stage) {
            queue.stage_ = stage;
            queue.backend_->make_current();
        }
    };

private:
    struct Allocation {
        void* memory;
        std::size_t bytes;
        std::string name;
    };

    explicit Queue(std::unique_ptr<DeviceBackend> backend, const Threads& threads = {})
        : backend_(std::move(backend)), threads_(threads) {}
    void fork_streams(int count) {
        streams_ = count;
        for (int i = 1; i < count; ++i) backend_->make_stream_wait(i, 0);
    }
    void join_streams() {
        for (int i = 1; i < streams_; ++i) backend_->make_stream_wait(0, i);
        streams_ = 1;
    }
    void use_stream(int index) {
        stream_index_ = index;
        backend_->use_stream(index);
    }

    std::unique_ptr<DeviceBackend> backend_;
    Threads threads_;
    const char* stage_ = "start";
    int stream_index_ = 0, streams_ = 1;
    std::vector<Allocation> allocations_;
    std::size_t allocated_ = 0, peak_ = 0;
    uint64_t allocation_count_ = 0, uploaded_ = 0;
};

} // namespace pertev
