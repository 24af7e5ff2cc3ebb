#pragma once

// The frames of a sequence in real time, of a scene on a device: each takes one sample of each pixel, and is
// reconstructed with what the frames before it have seen. It has the history, the reservoirs of ReSTIR, the temporal
// gradients of light, and what motion vectors compare with. A frame is a function of scene, camera, settings and number
// of all frames since the last cut, on every device alike. It needs no session.

#include <optional>

#include "denoise/light_change.h"
#include "denoise/reconstruction.h"
#include "device/device_timer.h"
#include "restir/restir.h"
#include "session/picture_renderer.h"

namespace pertev {

class FrameSequence {
public:
    /// `pictures` outlives it.
    explicit FrameSequence(PictureRenderer& pictures) : pictures_(pictures), sharing_timer_(pictures.queue()) {}

    /// Forgets what earlier frames have seen.
    void cut();
    /// To be called before each change of the scene, which is then in another state of the same sequence. Throws
    /// Error(OutOfMemory).
    void scene_changes();

    /// Renders sample `number` of each pixel and reconstructs the picture. `restir` is off if the path settings ask for
    /// indirect light alone, or find light by one strategy alone. Another resolution_scale is a cut. Returns false, and
    /// the frames begin anew, if the renderer was abandoned. Throws Error(OutOfMemory, DeviceFault), and
    /// Error(BadInput) for an integrator that makes no frames (makes_frames) or for an open shutter.
    bool render(uint32_t number, const Camera& camera, const RenderSettings& settings,
                const ReconstructionSettings& reconstruction, const RestirSettings& restir);

    // These are about the last frame. All but rays() and the seconds throw as render().

    Reconstruction& reconstruction() { return reconstruction_.value(); }
    /// For its exposure (session/adaptive_exposure.h).
    FrameTones tones() const;
    /// Returns the frame as a picture of one sample, and the layers that the settings ask for of that sample alone,
    /// without motion; ids are of sample 0, as those of any picture. It has no times and shares.
    RenderResult result(const Camera& camera, const RenderSettings& settings);
    RayCounts rays() const { return restir_ ? rays_ + RayCounts{0, 0, restir_->rays()} : rays_; }
    /// Seconds of its rays by kind, without those of ReSTIR; all 0 unless the settings ask for them (time_kinds).
    const SceneTracer::Seconds& kind_seconds() const { return kind_seconds_; }
    /// Seconds that ReSTIR took; 0 without it.
    double sharing_seconds() const { return restir_ ? sharing_timer_.seconds() : 0; }

    /// From now on motion() compares with the scene as it is now, seen by `camera`. Reconstruction begins anew. Throws
    /// Error(OutOfMemory).
    void keep_as_before(const Camera& camera);
    /// Returns how many pixels to the right and up each pixel of this picture has moved since keep_as_before(): 0 after
    /// a cut (denoise/motion_vectors.h). Throws Error(OutOfMemory, DeviceFault).
    Image motion(const Camera& camera, const RenderSettings& settings);

private:
    void take_sample(uint32_t number, const Camera& camera, RenderSettings settings, NoisyFrame& frame,
                     const std::atomic<bool>* abandon = nullptr);
    LightChangeView look_for_change(const RenderSettings& of_light, const ReconstructionSettings& settings);
    void keep_light(uint32_t number, const Camera& camera, const RenderSettings& of_light, bool goes_on);
    Restir* restir_for(const RestirSettings& settings, const RenderSettings& of_light);

    PictureRenderer& pictures_;
    std::optional<NoisyFrame> sample_;
    std::optional<NoisyFrame> features_; // if light is found at a lower resolution
    std::optional<Reconstruction> reconstruction_;
    std::optional<Restir> restir_;
    RestirSettings restir_settings_;      // of the last frame
    DeviceTimer sharing_timer_;           // of the last frame's reservoirs
    bool has_moved_ = false;              // since the last frame: the scene has places before
    std::optional<Camera> camera_before_; // of keep_as_before()
    bool scene_has_changed_ = false;      // since the last frame
    std::optional<LightChange> light_change_;
    /// The frame whose scene light_change_ holds.
    struct LightBefore {
        Camera camera;
        uint32_t number = 0;
        PathSettings path;
    };
    std::optional<LightBefore> light_before_;
    RayCounts rays_;
    SceneTracer::Seconds kind_seconds_;
    uint32_t number_ = 0;                          // of the last frame's sample
};

} // namespace pertev
