#pragma once

// Denoises pictures of one size by Open Image Denoise, guided by albedo and normals: on the GPU of a CUDA queue where
// the library has its module for it, else on the CPU. Its result is outside the one-picture law. The library's own
// memory, some hundred bytes per pixel and its weights, is not counted.

#include <memory>
#include <string>
#include <vector>

#include "denoise/oidn/oidn_library.h"
#include "device/buffer.h"
#include "math/float4.h"

namespace pertev {

enum class OidnQuality : uint8_t {
    Fast, // for frames, with the guides of a sample
    High, // with guides that are means over samples
};

class OidnFilter {
public:
    /// Makes the filter. Throws Error(BadInput) that names `setting` if there is no library (a dry run needs none), and
    /// Error(OutOfMemory, DeviceFault).
    OidnFilter(Queue& queue, uint32_t width, uint32_t height, OidnQuality quality, const char* setting);

    // The queue's arrays of a picture, one element per pixel, of which w is not used.
    Float4* color() const { return images_.data(); } // linear, in W/(sr m2)
    Float4* albedo() const { return images_.data() + pixels_; }
    Float4* normal() const { return images_.data() + 2 * pixels_; }

    /// Replaces color(), after all work queued before, and waits for it. Throws Error(OutOfMemory, DeviceFault).
    void run();
    /// Library, version, device and quality, as in "Open Image Denoise 2.5.1 on the CPU, high quality".
    const std::string& name() const { return name_; }

private:
    void make_device(bool on_cuda);
    void make_filter(OidnQuality quality);
    void check(void* device);

    Queue& queue_;
    uint32_t width_, height_;
    std::size_t pixels_;
    Buffer<Float4> images_;
    std::vector<Float4> host_images_; // a copy, if the library cannot read the queue's memory
    std::shared_ptr<const OidnLibrary> library_;
    std::string name_;
    std::shared_ptr<void> device_, filter_; // null in a dry run
};

} // namespace pertev
