#pragma once

// Denoises real-time frames by Open Image Denoise in fast quality, each by itself, guided by the hits of its sample.

#include "denoise/oidn/oidn_filter.h"
#include "render/noisy_frame.h"

namespace pertev {

class OidnFrames {
public:
    OidnFrames(Queue& queue, uint32_t width, uint32_t height)
        : queue_(queue), filter_(queue, width, height, OidnQuality::Fast, "frame_denoiser"), width_(width),
          height_(height) {}

    bool fits(const NoisyFrame& frame) const { return frame.width() == width_ && frame.height() == height_; }
    /// Returns the denoised picture of `shown` (shown_color), whose hits are in `frame`. It is valid until the next
    /// call.
    const Float4* apply(const Float4* shown, const NoisyFrame& frame);
    const std::string& name() const { return filter_.name(); }

private:
    Queue& queue_;
    OidnFilter filter_;
    uint32_t width_, height_;
};

} // namespace pertev
