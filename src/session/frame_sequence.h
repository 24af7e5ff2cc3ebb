#pragma once

// Real-time frames of a scene on a device: each takes one sample per pixel and is reconstructed with the history of
// earlier frames. It owns the history, the ReSTIR reservoirs, the temporal gradients of light, and the reference of
// motion vectors. A frame depends only on scene, camera, settings and numbers of all frames since the last cut, on
// every device alike. It needs no session.

#include <memory>
#include <optional>

#include "denoise/contacts.h"
#include "denoise/oidn/oidn_frames.h"
#include "denoise/reconstruction.h"
#include "denoise/temporal_gradients.h"
#include "device/device_timer.h"
#include "restir/restir.h"
#include "session/frame_history.h"
#include "session/shared_frames.h"

namespace pertev {

/// Returns the settings by which frames are reconstructed. Open Image Denoise takes the noise of pixels to be
/// independent, which a history's is not. Without history and filter no temporal gradients are needed.
inline ReconstructionSettings used_by_frames(const ReconstructionSettings& requested, const RestirSettings& restir) {
    ReconstructionSettings used = requested.denoiser == FrameDenoiser::Oidn ? of_samples_alone(requested) : requested;
    const bool keeps_reservoirs = restir.light != RestirLight::Off && restir.history > 0;
    const bool follows = used.history > 1 || used.passes > 0 || keeps_reservoirs;
    used.temporal_gradients = used.temporal_gradients && follows;
    return used;
}

class FrameSequence {
public:
    /// Makes an empty sequence; `pictures` outlives it.
    explicit FrameSequence(PictureRenderer& pictures) : pictures_(pictures), sharing_timer_(pictures.queue()) {}

    /// Discards the history.
    void cut();
    /// Must be called before each change of the scene within a sequence. Throws Error(OutOfMemory).
    void scene_changes();

    /// Renders sample `number` of each pixel and reconstructs the picture. What Open Image Denoise makes of it is only
    /// displayed, and no frame depends on it. `restir` is ignored if the path settings request indirect light only, or
    /// a single light strategy. Another resolution_scale is a cut. Returns false, and restarts the sequence, if `sink`
    /// stopped it, which only a CPU notices. Throws Error(OutOfMemory, DeviceFault), and Error(BadInput) for an
    /// integrator without frames (makes_frames), for an open shutter, or without the library.
    bool render(uint32_t number, const Camera& camera, const RenderSettings& settings,
                const ReconstructionSettings& reconstruction, const RestirSettings& restir, Sink& sink = nobody());

    /// Returns what the next frame needs of the last one, which there is (has_history). Throws Error(DeviceFault).
    FrameHistory history();
    /// Goes on after a frame of another sequence with the same settings. The scene is as it was in that frame. render()
    /// throws Error(BadInput) if the history does not fit. Throws as SharedFrames::take_scene.
    void restore(FrameHistory history, const RenderSettings& settings, Sink& sink);

    // For the sequences of devices that make frames together (SharedFrames).

    /// Makes this device's rows of a frame, and takes what they need of other rows from `others`; all rows if that is
    /// null. Returns as render().
    bool render_rows(const FrameTask& task, RowExchange* others, Sink& sink);
    PictureRenderer& pictures() const { return pictures_; }
    /// Takes over what the caller's sequence knows of cuts and of changes of the scene.
    void follow(const FrameSequence& leader);
    /// Returns whether the next frame depends on earlier ones.
    bool has_history() const { return restored_ || (reconstruction_ && reconstruction_->frames() > 0); }
    /// Returns whether the scene has to be kept as it is before it changes, because the next frame shows its motion.
    bool has_moved() const { return has_moved_; }
    bool scene_has_changed() const { return scene_has_changed_; }
    /// Discards the history, but not that the scene has changed.
    void begin_again(bool scene_has_changed) { cut(), scene_has_changed_ = scene_has_changed; }
    // Arrays of the last frame: the result; what tones() reads; all of the frame of the picture's size.
    std::vector<RowArray> rows_of_result() const { return reconstruction_.value().rows_of_result(); }
    std::vector<RowArray> rows_of_tones() const;
    std::vector<RowArray> rows_of_history() const;
    std::vector<RowArray> rows_of_guides() const { return guides().rows(); }
    FrameCounts counts() const;

    // The following functions refer to the last frame. All but the seconds throw as render().

    Reconstruction& reconstruction() { return reconstruction_.value(); }
    /// Tones of the frame for the exposure (session/adaptive_exposure.h).
    FrameTones tones();
    /// Returns the frame as a picture of one sample, with the requested layers of that sample, without motion; ids
    /// are of sample 0, as in any picture. It has no times and shares.
    RenderResult result(const Camera& camera, const RenderSettings& settings);
    RayCounts rays() const;
    /// Seconds of the frame's rays by kind, without those of ReSTIR; all 0 unless the settings request them
    /// (time_kinds). Like all seconds they are those of the caller's device.
    const SceneTracer::Seconds& kind_seconds() const { return kind_seconds_; }
    /// Seconds that ReSTIR took; 0 without it.
    double sharing_seconds() const { return restir_ ? sharing_timer_.seconds() : 0; }

    /// Makes the present scene, seen by `camera`, the reference of motion(). Reconstruction restarts. Throws
    /// Error(OutOfMemory).
    void store_previous(const Camera& camera);
    /// Returns the motion of each pixel since store_previous(), in pixels to the right and up; 0 after a cut
    /// (denoise/motion_vectors.h). Throws Error(OutOfMemory, DeviceFault).
    Image motion(const Camera& camera, const RenderSettings& settings);

private:
    struct FrameOfLight;

    NoisyFrame& fit_memory(const RenderSettings& of_light);
    void begin_exchange(const FrameTask& task, const RenderSettings& of_light);
    bool render_light(const FrameTask& task, const RenderSettings& of_light, NoisyFrame& frame, Sink& sink);
    PreviousScene scene_before(const PictureView& now);
    void reuse_light(Restir& restir, const FrameOfLight& made);
    void reconstruct(const FrameOfLight& made);
    void render_sample(uint32_t number, const Camera& camera, RenderSettings settings, NoisyFrame& frame,
                       Sink* sink = nullptr);
    void take_small(const NoisyFrame& frame);
    void take_restored(const FrameTask& task, const RenderSettings& of_light);
    void check(const FrameTask& task);
    void denoise();
    const NoisyFrame& guides() const { return features_ ? *features_ : sample_.value(); }
    TemporalGradientsView measure_gradients(const RenderSettings& of_light, const ReconstructionSettings& settings);
    void store_light(uint32_t number, const Camera& camera, const RenderSettings& of_light, bool goes_on);
    Restir* restir_for(const RestirSettings& settings, const RenderSettings& of_light);

    PictureRenderer& pictures_;
    RowExchange* others_ = nullptr; // while a frame is made together with them
    std::optional<NoisyFrame> sample_;
    std::optional<NoisyFrame> features_; // if light is found at a lower resolution
    std::optional<Reconstruction> reconstruction_;
    std::optional<OidnFrames> oidn_;        // if it denoises frames
    std::optional<ContactFinder> contacts_; // if frames follow the change of light
    std::optional<Restir> restir_;
    RestirSettings restir_settings_;      // settings of the last frame
    DeviceTimer sharing_timer_;           // time of the last frame's reservoirs
    bool has_moved_ = false;              // whether the scene has moved since the last frame and holds its previous
                                          // positions
    std::optional<Camera> camera_before_; // camera of store_previous()
    bool scene_has_changed_ = false;      // since the last frame
    std::optional<TemporalGradients> temporal_gradients_;
    /// The frame whose scene temporal_gradients_ shows.
    struct LightBefore {
        Camera camera;
        uint32_t number = 0;
        PathSettings path;
    };
    std::optional<LightBefore> light_before_;
    std::shared_ptr<const FrameHistory> restored_; // until the next frame takes it
    RayCounts rays_;
    SceneTracer::Seconds kind_seconds_;
    uint32_t number_ = 0; // sample number of the last frame
    Camera camera_;       // camera of the last frame
};

} // namespace pertev
