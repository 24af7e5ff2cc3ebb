#pragma once

// A picture from one sample a pixel and what was seen in the frames before: spatiotemporal variance-guided filtering
// with what came after it. Its stages, in their order, are the files of this folder that the .cpp launches; each is one
// function for both devices, so a frame has the same bytes on each. A frame is a function of its noisy frame, cameras,
// settings and the frames since the last cut.
//
// Source: Schied et al., "Spatiotemporal Variance-Guided Filtering: Real-Time Reconstruction for Path-Traced Global
// Illumination", HPG 2017.

#include <memory>

#include "denoise/reconstruction_settings.h"
#include "denoise/reconstruction_view.h"
#include "device/device_timer.h"
#include "image/image.h"
#include "image/tone_map.h"
#include "render/noisy_frame.h"

namespace pertev {

/// Means of a frame over square blocks of pixels, some 40 along its longer side.
struct FrameTones {
    Image scattered; // RGBA: what surfaces scatter to the camera, without lamps and sky that are seen directly; the
                     // share of the block that this is true of, with which the others are multiplied already
    Image all;       // RGB
};

class Reconstruction {
public:
    Reconstruction(Queue& queue, uint32_t width, uint32_t height);

    static std::size_t predicted_bytes(uint32_t width, uint32_t height);

    /// What follows has nothing to do with what was seen before.
    void cut() { frames_ = 0; }
    /// Makes the picture of `frame`, which has this size, seen by `camera` in `scene`. `before`: where things stood in
    /// the frame before; looked at only where there is one.
    void add(const NoisyFrame& frame, const CameraView& camera, const SceneView& scene, const PreviousScene& before,
             const ReconstructionSettings& settings);

    /// Frames since the last cut.
    uint32_t frames() const { return frames_; }
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    /// On the device, of the last add(). Waits for it.
    double seconds() const { return timer_.seconds(); }
    /// RGB, linear, of the last frame.
    Image picture() const;
    /// The same as a display shows it, times 2^exposure_stops: RGBA, [height * width * 4], until the next call.
    const uint8_t* display(ToneMap tone_map, float exposure_stops);
    /// Of the last frame, which was made of `frame`.
    FrameTones tones(const NoisyFrame& frame) const;

    // Of the last frame, where ReconstructionSettings::keep_layers was set.

    /// Two channels: pixels that what is seen has moved since the frame before, to the right and down.
    Image motion() const;
    /// One channel: deviation of the luminance of both signals together, as it leads the filter; 1000 and more: not
    /// known yet.
    Image deviation() const;

private:
    HistoryView history(uint32_t frame) const;
    std::vector<Float4> kept_layers() const;

    Queue* queue_;
    uint32_t width_, height_, frames_ = 0;
    CameraView last_camera_ = {};
    DeviceTimer timer_;
    Buffer<Float4> wide_; // arrays of Float4, of both histories and of signals
    Buffer<Vec2> narrow_;
    std::unique_ptr<HostCopy> display_; // none before it is asked for
    Buffer<Float4> layers_; // empty until somebody asks for them
};

} // namespace pertev
