#pragma once

// Two pieces of pinned memory for copies between ordinary host memory and a device. The device reads pinned memory
// itself, so one piece is filled (or emptied) while the other is being transferred, and the host's source may change
// as soon as the call returns.

#include <cuda_runtime.h>

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "device/cuda/check_cuda.h"

namespace pertev {

class PinnedStaging {
public:
    /// Copies are queued on `stream`, which belongs to the current device and outlives this.
    explicit PinnedStaging(cudaStream_t stream) : stream_(stream) {
        for (Piece& piece : pieces_) {
            const cudaError_t error = cudaHostAlloc(&piece.memory, kBytes, cudaHostAllocDefault);
            const bool has_event =
                error == cudaSuccess && cudaEventCreateWithFlags(&piece.sent, cudaEventDisableTiming) == cudaSuccess;
            is_there_ = is_there_ && has_event;
        }
        if (!is_there_) cudaGetLastError(); // clears it; copies work without staging
    }
    ~PinnedStaging() {
        cudaStreamSynchronize(stream_); // pending copies use the pieces
        for (const Piece& piece : pieces_) {
            if (piece.sent != nullptr) cudaEventDestroy(piece.sent);
            cudaFreeHost(piece.memory);
        }
    }
    PinnedStaging(const PinnedStaging&) = delete;
    PinnedStaging& operator=(const PinnedStaging&) = delete;

    /// Returns false if the system has no memory to pin; then nothing else may be called.
    bool is_there() const { return is_there_; }

    /// Returns when all of `host` has been read, possibly before it has arrived.
    void copy_to_device(void* device, const void* host, std::size_t bytes) {
        auto* to = static_cast<std::byte*>(device);
        const auto* from = static_cast<const std::byte*>(host);
        while (bytes > 0) {
            if (used_ == kBytes) take_other_piece();
            const std::size_t count = std::min(bytes, kBytes - used_);
            std::byte* const staged = static_cast<std::byte*>(pieces_[current_].memory) + used_;
            std::memcpy(staged, from, count);
            check_cuda(cudaMemcpyAsync(to, staged, count, cudaMemcpyHostToDevice, stream_), "copy to device");
            used_ = std::min(kBytes, (used_ + count + kAlignment - 1) / kAlignment * kAlignment);
            to += count;
            from += count;
            bytes -= count;
        }
    }

    /// Returns when `host` is complete.
    void copy_to_host(void* host, const void* device, std::size_t bytes) {
        check_cuda(cudaStreamSynchronize(stream_), "copy to host"); // frees both pieces
        used_ = 0;
        const std::size_t parts = (bytes + kBytes - 1) / kBytes;
        const auto size_of = [&](std::size_t part) { return std::min(kBytes, bytes - part * kBytes); };
        const auto fetch = [&](std::size_t part) {
            const Piece& piece = pieces_[part % 2];
            check_cuda(cudaMemcpyAsync(piece.memory, static_cast<const std::byte*>(device) + part * kBytes,
                                       size_of(part), cudaMemcpyDeviceToHost, stream_),
                       "copy to host");
            check_cuda(cudaEventRecord(piece.sent, stream_), "copy to host");
        };
        if (parts > 0) fetch(0);
        for (std::size_t part = 0; part < parts; ++part) {
            if (part + 1 < parts) fetch(part + 1);
            check_cuda(cudaEventSynchronize(pieces_[part % 2].sent), "copy to host");
            std::memcpy(static_cast<std::byte*>(host) + part * kBytes, pieces_[part % 2].memory, size_of(part));
        }
    }

private:
    static constexpr std::size_t kBytes = std::size_t(8) << 20; // per piece
    static constexpr std::size_t kAlignment = 256;

    struct Piece {
        void* memory = nullptr;
        cudaEvent_t sent = nullptr; // after all copies from or to it
    };

    void take_other_piece() {
        check_cuda(cudaEventRecord(pieces_[current_].sent, stream_), "copy to device");
        current_ = 1 - current_;
        check_cuda(cudaEventSynchronize(pieces_[current_].sent), "copy to device"); // immediate if never recorded
        used_ = 0;
    }

    cudaStream_t stream_;
    Piece pieces_[2];
    bool is_there_ = true;
    int current_ = 0;
    std::size_t used_ = 0; // bytes of the current piece used by uploads
};

} // namespace pertev
