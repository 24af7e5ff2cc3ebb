#pragma once

// A picture from one sample a pixel and what was seen in the frames before: spatiotemporal variance-guided filtering
// with what came after it. Its stages, in their order, are the files of this folder that the .cpp launches; each is one
// function for both devices, so a frame has the same bytes on each. A frame is a function of its noisy frame, cameras,
// settings and the frames since the last cut.
//
// Source: Schied et al., "Spatiotemporal Variance-Guided Filtering: Real-Time Reconstruction for Path-Traced Global
// Illumination", HPG 2017.

#include <memory>
#include <optional>

#include "denoise/enlarged_frame.h"
#include "denoise/light_change.h"
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

    /// What follows has nothing to do with what was seen before.
    void cut() { frames_ = 0; }
    /// Makes the picture of `frame`, which has this size, seen by `camera` in `scene`. `before`: where things stood in
    /// the frame before; looked at only where there is one. `change`: of light since then.
    void add(const NoisyFrame& frame, const CameraView& camera, const SceneView& scene, const PreviousScene& before,
             const LightChangeView& change, const ReconstructionSettings& settings);

    /// The same of a picture of another size, that of `features`: a frame whose paths end at the first surface, seen by
    /// `camera`. `frame`, the light, is seen by `light_camera`. A picture of another size than the one before is a cut.
    void add_enlarged(const NoisyFrame& frame, const CameraView& light_camera, const NoisyFrame& features,
                      const CameraView& camera, const SceneView& scene, const PreviousScene& before,
                      const LightChangeView& change, const ReconstructionSettings& settings);

    /// For `change` of the next add(): free from one add() to the next.
    LightChangeRoom room_for_change() const;
    /// Frames since the last cut.
    uint32_t frames() const { return frames_; }
    /// Of the light; the picture's where it is not enlarged.
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    /// Of the picture: more than those of the light where it was enlarged.
    uint32_t shown_width() const { return enlarged_ ? enlarged_->width() : width_; }
    uint32_t shown_height() const { return enlarged_ ? enlarged_->height() : height_; }
    /// On the device, of the last add(). Waits for it.
    double seconds() const { return timer_.seconds(); }
    /// RGB, linear, of the last frame.
    Image picture() const;
    /// Brings the same to the host as a display shows it, times 2^exposure_stops.
    void display(ToneMap tone_map, float exposure_stops);
    /// What the last display() brought.
    Rgba8Image displayed() const;
    /// That bringing it to the host took, after all that made it. Waits for it.
    double copy_seconds() const { return copy_timer_.seconds(); }
    /// Of the last picture, which was made of `frame`; of an enlarged one, `frame` is its features.
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
    SignalsView filter(const NoisyFrame& frame, const CameraView& camera, const SceneView& scene,
                       const PreviousScene& before, const LightChangeView& change,
                       const ReconstructionSettings& settings, Float4*& room);
    Vec2* places_before() const { return narrow_.data() + 2 * std::size_t(width_) * height_; }
    const Float4* shown() const;

    Queue* queue_;
    uint32_t width_, height_, frames_ = 0;
    CameraView last_camera_ = {};
    DeviceTimer timer_, copy_timer_;
    Buffer<Float4> wide_; // arrays of Float4, of both histories and of signals
    Buffer<Vec2> narrow_;
    std::unique_ptr<HostCopy> display_; // none before it is asked for
    std::size_t display_bytes_ = 0;
    Buffer<Float4> layers_;                 // empty until somebody asks for them
    std::optional<EnlargedFrame> enlarged_; // where the picture has another size than its light
};

} // namespace pertev
