#pragma once

// The part of NVIDIA's nvJPEG that encodes pictures, loaded at run time from wherever the system has it, so that it
// is not needed to build or start the program. The declarations are our own.
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
    /// Library names that are tried in order.
    static std::span<const char* const> libraries();

    /// Returns null if none of `libraries` is found, it lacks a function, or it fails to start. Work uses `queue`,
    /// which outlives it, by one thread at a time. Throws Error(DeviceFault).
    static std::unique_ptr<Nvjpeg> load(Queue& queue, std::span<const char* const> libraries);
    ~Nvjpeg();
    Nvjpeg(const Nvjpeg&) = delete;
    Nvjpeg& operator=(const Nvjpeg&) = delete;

    /// Encodes like encode_jpeg_strips, though not to the same bytes. Returns an empty file on failure. Throws
    /// Error(OutOfMemory, DeviceFault).
    std::vector<std::byte> encode(const Rgba8Image& picture, int quality, bool half_chroma);

private:
    struct Functions;
    Nvjpeg(Queue& queue, void* library, std::unique_ptr<Functions> functions);
    bool begin();

    Queue& queue_;
    void* library_;
    std::unique_ptr<Functions> functions_;
    void *handle_ = nullptr, *state_ = nullptr, *parameters_ = nullptr; // handles of the library
    std::vector<uint8_t> rgb_;
    Buffer<uint8_t> pixels_; // on the device
};

} // namespace pertev
