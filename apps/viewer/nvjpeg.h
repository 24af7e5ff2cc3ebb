#pragma once

// NVIDIA's nvJPEG, as far as pictures are packed by it: loaded when the program runs, from wherever the system has it,
// so that nothing is needed to build or to start. The declarations are our own.
//
// Source: NVIDIA, "nvJPEG", CUDA Toolkit Documentation, sections "JPEG Encoding" and "nvJPEG Encoder API Reference";
// the same from CUDA 11 to 13.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "device/buffer.h"
#include "image/image.h"

namespace pertev {

class Nvjpeg {
public:
    /// Names that the system's loader is asked for, in turns.
    static std::span<const char* const> libraries();

    /// Null where none of `libraries` is there, it lacks a function, or it does not begin. Work is given to `queue`,
    /// which outlives it, and is for one thread at a time. Throws Error(DeviceFault).
    static std::unique_ptr<Nvjpeg> load(Queue& queue, std::span<const char* const> libraries);
    ~Nvjpeg();
    Nvjpeg(const Nvjpeg&) = delete;
    Nvjpeg& operator=(const Nvjpeg&) = delete;

    /// As encode_jpeg_strips, though not to the same bytes. Empty where that failed. Throws Error(OutOfMemory,
    /// DeviceFault).
    std::vector<std::byte> encode(const Rgba8Image& picture, int quality, bool half_chroma);

private:
    struct Functions;
    Nvjpeg(Queue& queue, void* library, std::unique_ptr<Functions> functions);
    bool begin();

    Queue& queue_;
    void* library_;
    std::unique_ptr<Functions> functions_;
    void *handle_ = nullptr, *state_ = nullptr, *parameters_ = nullptr; // the library's own
    std::vector<uint8_t> rgb_;
    Buffer<uint8_t> pixels_; // on the device
};

} // namespace pertev
