#pragma once

// Reconstructs a picture from one sample per pixel and previous frames: spatiotemporal variance-guided filtering with
// later extensions. Its stages, in order, are the files of this folder that the .cpp launches. Each is one function
// for both devices, so a frame has the same bytes on each. A frame depends only on its noisy frame, cameras, settings
// and the frames since the last cut.
//
// Source: Schied et al., "Spatiotemporal Variance-Guided Filtering: Real-Time Reconstruction for Path-Traced Global
// Illumination", HPG 2017.

#include <memory>
#include <optional>

#include "denoise/reconstruction_settings.h"
#include "denoise/reconstruction_view.h"
#include "denoise/temporal_gradients.h"
#include "denoise/upsampled_frame.h"
#include "device/device_timer.h"
#include "image/image.h"
#include "image/tone_map.h"
#include "render/noisy_frame.h"
#include "render/row_exchange.h"

namespace pertev {

/// Means of a frame over square blocks of pixels, some 40 along its longer side.
struct FrameTones {
    Image scattered; // RGBA: light that surfaces scatter to the camera, without directly visible emitters and sky;
                     // alpha is the fraction of the block to which this applies, by which the colours are
                     // premultiplied
    Image all;       // RGB
};

class Reconstruction {
public:
    Reconstruction(Queue& queue, uint32_t width, uint32_t height);

    /// Discards the history, because the next frame is unrelated to it.
    void cut() { frames_ = 0; }
    /// Makes the next frames compute only this device's rows and take the rest from `others`; with null they compute
    /// all rows. Before a frame, rows_of_history() must hold the rows of the last frame that others computed.
    void share(RowExchange* others) { others_ = others; }
    /// Arrays of the last frame that the next one needs; none after a cut.
    std::vector<RowArray> rows_of_history() const;
    /// Continues after a frame that another reconstruction made; the caller then fills rows_of_history(). `frame` is
    /// like its samples, and `light_camera` has seen them; `features` and `camera` are those of add_upsampled, else
    /// null.
    void begin_after(const NoisyFrame& frame, const CameraView& light_camera, const NoisyFrame* features,
                     const CameraView& camera);
    /// Arrays of the last frame that the functions below show.
    std::vector<RowArray> rows_of_result() const;
    /// Makes the picture of `frame`, which has this size, seen by `camera` in `scene`. `before` has the positions in
    /// the previous frame, and is used only if there is one. `change` is the change of light since then.
    void add(const NoisyFrame& frame, const CameraView& camera, const SceneView& scene, const PreviousScene& before,
             const TemporalGradientsView& change, const ReconstructionSettings& settings);

    /// Makes a picture at another resolution, that of `features`: a frame whose paths end at the first surface, seen
    /// by `camera`. `frame`, the light, belongs to `light_camera`. A change of the picture's size is a cut.
    void add_upsampled(const NoisyFrame& frame, const CameraView& light_camera, const NoisyFrame& features,
                       const CameraView& camera, const SceneView& scene, const PreviousScene& before,
                       const TemporalGradientsView& change, const ReconstructionSettings& settings);

    /// Memory for `change` of the next add(), free from one add() to the next.
    TemporalGradientsMemory gradients_memory() const;
    /// Number of frames since the last cut.
    uint32_t frames() const { return frames_; }
    /// Size of the light, which is that of the picture unless it is upsampled.
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    /// Size of the picture, larger than that of the light if it is upsampled.
    uint32_t shown_width() const { return upsampled_ ? upsampled_->width() : width_; }
    uint32_t shown_height() const { return upsampled_ ? upsampled_->height() : height_; }
    /// Device time of the last add(), in seconds. Waits for it.
    double seconds() const { return timer_.seconds(); }
    /// Picture of the last frame: RGB, linear.
    Image picture() const { return image_of(shown()); }
    /// The last frame in shown_color.
    const Float4* shown() const;
    /// Lets displays show `picture` (shown_color), which must stay valid meanwhile, in place of the last frame.
    void show_instead(const Float4* picture) { instead_ = picture; }
    /// Returns the picture that displays show in place of the last frame; nothing without show_instead().
    std::optional<Image> shown_instead() const;
    /// Computes the last frame's picture for a display, times 2^exposure_stops, and starts its copy to the host.
    void display(ToneMap tone_map, float exposure_stops);
    /// The picture of the last display().
    Rgba8Image displayed() const;
    /// Time that the copy of displayed() to the host took, in seconds, after everything before. Waits for the copy.
    double copy_seconds() const { return copy_timer_.seconds(); }
    /// Tones of the last picture, which was made from `frame`; for an upsampled one `frame` is its features.
    FrameTones tones(const NoisyFrame& frame) const;

    // Layers of the last frame, if ReconstructionSettings::keep_layers was set.

    /// Motion since the previous frame, in pixels to the right and down, in two channels.
    Image motion() const;
    /// Standard deviation of the luminance of both signals together, as the filter uses it, in one channel; 1000
    /// and more means unknown.
    Image deviation() const;

private:
    HistoryView history(uint32_t frame) const;
    std::vector<Float4> kept_layers() const;
    SteadyLight steady_light(const HistoryView& now, bool may_change, const ReconstructionSettings& settings) const;
    SignalsView filter(const NoisyFrame& frame, const CameraView& camera, const SceneView& scene,
                       const PreviousScene& before, const TemporalGradientsView& change,
                       const ReconstructionSettings& settings, RowBand rows, Float4*& memory);
    Vec2* positions_before() const { return narrow_.data() + 2 * std::size_t(width_) * height_; }
    Image image_of(const Float4* picture) const;

    Queue* queue_;
    RowExchange* others_ = nullptr;
    bool has_gloss_ = false, keeps_layers_ = false; // in the last frame
    uint32_t width_, height_, frames_ = 0;
    CameraView last_camera_ = {};
    DeviceTimer timer_, copy_timer_;
    Buffer<Float4> wide_; // arrays of both histories and of signals
    Buffer<Vec2> narrow_;
    std::unique_ptr<HostCopy> display_; // null before the first display()
    std::size_t display_bytes_ = 0;
    const Float4* instead_ = nullptr;         // null: displays show the last frame
    Buffer<Float4> layers_;                   // empty until they are requested
    std::optional<UpsampledFrame> upsampled_; // exists if the picture has another size than its light
};

} // namespace pertev
