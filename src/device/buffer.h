#pragma once

// An array in device memory, owned here and passed on as a plain pointer in views.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "device/queue.h"

namespace pertev {

template <class T>
class Buffer {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    Buffer() = default;
    /// Allocates `count` elements without initialising them. `name` appears in the message of Error(OutOfMemory).
    Buffer(Queue& queue, std::size_t count, const std::string& name)
        : queue_(&queue), data_(static_cast<T*>(queue.allocate(count * sizeof(T), name))), count_(count) {}
    /// Allocates a buffer with a copy of `values`.
    Buffer(Queue& queue, std::span<const T> values, const std::string& name) : Buffer(queue, values.size(), name) {
        upload(values);
    }
    ~Buffer() {
        if (queue_ != nullptr) queue_->free(data_);
    }
    Buffer(Buffer&& other) noexcept
        : queue_(std::exchange(other.queue_, nullptr)), data_(std::exchange(other.data_, nullptr)),
          count_(std::exchange(other.count_, 0)) {}
    Buffer& operator=(Buffer&& other) noexcept {
        std::swap(queue_, other.queue_);
        std::swap(data_, other.data_);
        std::swap(count_, other.count_);
        return *this;
    }

    /// Grows the buffer to at least `count` elements, whose values are undefined. The smaller one is freed first, so
    /// that both need not fit into memory.
    void grow(Queue& queue, std::size_t count, const std::string& name) {
        if (count_ >= count) return;
        *this = Buffer();
        *this = Buffer(queue, count, name);
    }

    T* data() const { return data_; }
    std::size_t size() const { return count_; }

    /// Copies at most size() values to the start of the buffer.
    void upload(std::span<const T> values) {
        if (!values.empty()) queue_->copy_to_device(data_, values.data(), values.size_bytes());
    }
    /// Copies values to elements [first, ...) of the buffer, which must have room for them.
    void upload_at(std::size_t first, std::span<const T> values) {
        if (!values.empty()) queue_->copy_to_device(data_ + first, values.data(), values.size_bytes());
    }
    std::vector<T> download() const {
        std::vector<T> values(count_);
        if (count_ > 0) queue_->copy_to_host(values.data(), data_, count_ * sizeof(T));
        return values;
    }
    /// Returns the elements for reading on the host: in place, or in `copy` if the device has its own memory.
    std::span<const T> read(std::vector<T>& copy) const {
        if (queue_ == nullptr || !queue_->is_cuda()) return {data_, count_};
        copy = download();
        return copy;
    }
    void zero() { fill(0); }
    /// Sets every byte of the buffer to `value`.
    void fill(unsigned char value) {
        if (count_ > 0) queue_->fill(data_, value, count_ * sizeof(T));
    }

private:
    Queue* queue_ = nullptr;
    T* data_ = nullptr;
    std::size_t count_ = 0;
};

} // namespace pertev
