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

private:
    HistoryView history(uint32_t frame) const;

    Queue* queue_;
    uint32_t width_, height_, frames_ = 0;
    CameraView last_camera_ = {};
    DeviceTimer timer_;
    Buffer<Float4> wide_; // arrays of Float4, of both histories and of signals
    Buffer<Vec2> narrow_;
    std::unique_ptr<HostCopy> display_; // none before it is asked for
};

} // namespace pertev
