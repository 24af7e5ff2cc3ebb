#pragma once

// A frame whose light was reconstructed at a lower resolution than its surfaces: upsamples the picture
// (upsample_picture.h), and computes its temporal mean (anti_alias.h).

#include "denoise/anti_alias.h"
#include "denoise/reconstruction_settings.h"
#include "denoise/upsample_picture.h"
#include "device/buffer.h"
#include "render/noisy_frame.h"

namespace pertev {

class UpsampledFrame {
public:
    /// Allocates memory for a picture of this size.
    UpsampledFrame(Queue& queue, uint32_t width, uint32_t height);

    /// Makes the next picture from `light`. `features` is a frame of the picture's size, seen by `camera`, whose paths
    /// end at the first surface.
    void add(const NoisyFrame& features, const CameraView& camera, const CoarseLight& light, const SteadyLight& steady,
             const SceneView& scene, const PreviousScene& before, const ReconstructionSettings& settings,
             bool has_history, RowExchange* others = nullptr);
    /// Marks shown(), which the caller then fills, as the picture before the next one, rendered with `camera`.
    void begin_after(const CameraView& camera) { last_camera_ = camera; }
    /// Rows of the light, `height` in all, that this device's rows of the picture read.
    RowBand rows_of_light(const RowExchange* others, uint32_t height) const;

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    /// The last picture as shown_color; w is that of AntiAlias.
    Float4* shown() const { return shown(frames_); }
    /// [pixels * 4]: memory for the bytes of a display.
    uint8_t* byte_memory() const { return reinterpret_cast<uint8_t*>(picture_); }
    /// Memory for Reconstruction::tones().
    Float4* tone_memory() const { return tones_.data(); }

private:
    Float4* shown(uint32_t frame) const;

    Queue* queue_;
    uint32_t width_, height_, frames_ = 0;
    CameraView last_camera_ = {};
    Buffer<Float4> wide_;
    Buffer<Vec2> was_at_;
    Float4* picture_;
    Buffer<Float4> tones_;
};

} // namespace pertev
