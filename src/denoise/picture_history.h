#pragma once

// Light of earlier frames for the denoiser of pictures (denoise/picture_denoiser.h), if these are frames of a sequence:
// the mean signals of each pixel's samples before the filter, and the surfaces on which they were found. A frame takes
// those of the frame before to its own pixels, mixes them with its samples (denoise/mix_history.h) and leaves the
// result to the next one. What mirrors show has no history.

#include <span>
#include <vector>

#include "denoise/picture_sums.h"
#include "device/buffer.h"

namespace pertev {

/// Light of earlier frames at each pixel.
struct PictureHistoryView {
    Float4* diffuse; // rgb, mean of the signal; number of samples, 0 if unknown
    Float4* gloss;
    Vec2* variances; // variance of a sample of both
};

class NoisyFrame;

class PictureHistory {
public:
    /// Makes a history of at most `frames` - 1 frames with `samples` samples of each pixel.
    PictureHistory(Queue& queue, uint32_t width, uint32_t height, uint32_t samples, uint32_t frames);

    /// Returns whether a frame has left light to the next one since the last cut().
    bool is_there() const { return is_there_; }
    /// Discards the history: the next frame has none.
    void cut();

    /// Begins a frame after the one that left a history. `centres` has the hits of rays of the camera `now` through
    /// pixels' centres, which `guide` shows; `before` is where the scene was in the frame before.
    void follow(const NoisyFrame& centres, const PictureGuide& guide, const CameraView& now, const SceneView& scene,
                const PreviousScene& before);
    /// Returns where EstimateVariance stores variances of samples.
    Vec2* of_sample() const { return narrow_.data() + 2 * pixels_; }
    /// Mixes the present `signals` with the history, and keeps the result, seen by `camera`, for the next frame.
    /// `guide` is packed; `free` are overwritten. It may be called again after more samples.
    void mix(const PictureSums& sums, const SignalsView& signals, const Float4* guide, SignalsView free, bool has_gloss,
             const CameraView& camera);

    /// Returns the arrays of the history on the host.
    std::vector<std::vector<std::byte>> save() const;
    /// Takes what save() returned for a frame seen by `camera`. Throws Error(BadInput) if it does not fit.
    void restore(std::span<const std::vector<std::byte>> arrays, const CameraView& camera);

private:
    struct Array {
        void* data;
        std::size_t bytes;
    };
    std::vector<Array> arrays() const;
    Float4* wide(std::size_t array) const { return wide_.data() + array * pixels_; }
    HistoryView kept() const { return {wide(0), wide(1), wide(2), narrow_.data(), nullptr, nullptr}; }
    PictureHistoryView reprojected() const { return {wide(3), wide(4), narrow_.data() + pixels_}; }

    Queue* queue_;
    std::size_t pixels_;
    uint32_t width_, height_;
    Buffer<Float4> wide_;
    Buffer<Vec2> narrow_;
    CameraView camera_ = {}; // camera of the history
    float samples_, most_;   // per pixel, of a frame and at most of its history
    bool is_there_ = false;
};

} // namespace pertev
