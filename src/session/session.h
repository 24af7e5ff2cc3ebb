#pragma once

// Rendering that lives over time: one object for as long as there is something to render. It keeps the scene on the
// device, the film and the integrator with its queues; what does not change is not uploaded, allocated or built again.
//
// Samples gather in the film until something changes the picture: then the film begins anew. These calls do that:
//   set_scene     always. Uploads the scene; takes memory for its trees and for parts that are larger than before, none
//                 for film and queues.
//   update_scene  always. Uploads those parts alone, of trees only what has become another, and of meshes that deform
//                 joints and weights: their vertices and trees are made on the device. Takes memory for parts that are
//                 larger than before.
//   set_camera    where the camera is another. Uploads and takes nothing.
//   set_settings  where the picture is another (same_picture). Another size or other layers take a new film at the next
//                 render, and larger queues where they must be larger; another tracer takes its structure. All else
//                 takes nothing. Another frame_depth is a cut of the frames alone, and the film stays.
//   cut           always.
// Whatever came before, the picture of n samples is what a fresh session gives, to the byte; so is one of a samples
// with b added. One thread at a time.

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "denoise/light_change.h"
#include "denoise/picture_denoiser.h"
#include "denoise/reconstruction.h"
#include "device/device_timer.h"
#include "device_scene/scene_on_device.h"
#include "image/tone_map_image.h"
#include "render/filter_table.h"
#include "render/picture_view.h"
#include "render/prepare_scene.h"
#include "restir/restir.h"
#include "settings/render_settings.h"

namespace pertev {

/// What later frames may know of earlier ones.
struct History {
    uint32_t samples = 0; // whole samples of all pixels in the film, since it began
    /// The camera of the last samples before the present camera's; none since the last cut.
    std::optional<Camera> previous_camera;
    /// Changes after which nothing that was seen before can be used: all that begin the film anew, but set_camera.
    uint64_t cuts = 0;
};

class Session {
public:
    /// Uploads `scene`, which may go away afterwards, as may the Scene it was made from. `queue` outlives the session.
    /// Throws Error(OutOfMemory, DeviceFault), and what set_settings throws.
    Session(Queue& queue, const PreparedScene& scene, const Camera& camera, const RenderSettings& settings);

    /// As the constructor. The scene before is freed first, so that two need not fit; when this throws there is none,
    /// and the next set_scene must come before anything is rendered or metered.
    void set_scene(const PreparedScene& scene);
    /// The same scene after a change: only `parts` (ScenePart) are taken from `scene`, and nothing else of it may
    /// differ from what the session has. No cut: the next samples are a later frame of the same sequence. Throws as
    /// set_scene.
    void update_scene(const PreparedScene& scene, uint32_t parts);
    void set_camera(const Camera& camera);
    /// Throws what check_integrator does, and Error(BadInput), and nothing is done, where the device has no such
    /// tracer; Error(OutOfMemory, OverLimit) where the structure of another one cannot be had: the next set_settings
    /// must then come before anything is rendered.
    void set_settings(const RenderSettings& settings);
    /// What was seen before tells nothing of what comes (a camera that jumps, a measurement that begins again).
    void cut();

    /// Adds `samples` samples to each pixel, or fewer: it ends where the time of the settings is over, where
    /// `keep_going`, called after each pass, returns false, and at kMaxSamplesPerPixel in the film; always at a whole
    /// sample of all pixels. Where a sample takes long (Integrator::render_while) `keep_going` is called during passes
    /// too, with the samples that the film has by then. Returns how many were added: at least one where one was asked
    /// for and fits, but none where `keep_going` ended the first pass, or it was abandoned. Where an integrator makes
    /// something before samples (Integrator::make_ready), `keep_going` is called during that too, with the samples that
    /// the film has and the share that is made; where that, the time or, on the CPU, the flag of abandon_when ends it,
    /// nothing is added and the film stays as it is. Throws Error(OutOfMemory, DeviceFault), as all that take samples
    /// what check_camera does, and what `keep_going` throws; the film then holds all passes done before.
    uint32_t render(uint32_t samples, const std::function<bool(const RenderProgress&)>& keep_going = {});

    /// Of the present picture; without samples, all zero.
    const Film& film() { return current_film(); }
    Image picture() { return current_film().picture(history_.samples, settings_.transparent); }
    /// Reconstructed of the samples in the film; none where the settings do not ask for it, or there are no samples.
    /// Throws Error(DeviceFault).
    std::optional<Image> denoised();
    /// Auxiliary layers, then those of light paths.
    std::vector<FilmLayer> layers();
    /// Brings the picture to the host as a display shows it, times 2^exposure_stops: tone_map_image of picture().
    void display(ToneMap tone_map, float exposure_stops);
    /// What the last display() brought.
    Rgba8Image displayed();
    /// Reads two numbers back. The share of hidden backs is counted once for each scene, camera and size that is asked
    /// about.
    RenderStats stats();
    /// Picture, denoised picture, layers, ids, motion vectors and stats together.
    RenderResult result();

    /// From now on the frame before is the scene and camera as they are: what motion vectors (kAovMotion) are from.
    /// None after a cut, and they are then 0. Reconstruction begins anew. Throws Error(OutOfMemory).
    void keep_as_before();
    /// Pixels to the right and up that each pixel has moved since the frame before (denoise/motion_vectors.h). Throws
    /// Error(OutOfMemory, DeviceFault).
    Image motion();

    /// Stops for the present picture (session/meter_exposure.h), found over the scene as it lies on the device: nothing
    /// is uploaded. The film stays as it is. Throws Error(OutOfMemory, DeviceFault).
    float meter(ToneMap tone_map);

    /// A frame of a sequence: renders sample `number` of each pixel and reconstructs the picture from it and from the
    /// frames since the last cut, each of which had its own scene and camera. The film stays as it is. The frame is
    /// a function of scene, camera, settings and number of each of these frames, on every device alike. `restir` is
    /// off where the path settings ask for indirect light alone, or find lights by one strategy alone. Returns false,
    /// and the frames begin anew, where the flag of abandon_when broke it off. Throws Error(OutOfMemory, DeviceFault),
    /// and Error(BadInput) for an integrator that makes no frames (makes_frames).
    bool render_frame(uint32_t number, const ReconstructionSettings& settings, const RestirSettings& restir = {});
    /// Of the last render_frame, for its exposure (session/adaptive_exposure.h). Throws as render_frame.
    FrameTones frame_tones() const;
    /// Of the last render_frame. Another resolution_scale is a cut.
    Reconstruction& frame();
    /// The last render_frame as a picture of one sample: the frame, and the layers that the settings ask for of that
    /// sample alone (no motion); ids are of sample 0, as any picture's. Without times and shares. Throws as
    /// render_frame.
    RenderResult frame_result();
    /// Rays of the last render_frame.
    RayCounts frame_rays() const;
    /// Seconds of the last render_frame's rays by kind, but for those of sharing light; all 0 unless the settings ask
    /// for them (time_kinds).
    const SceneTracer::Seconds& frame_kind_seconds() const { return frame_kind_seconds_; }
    /// Seconds that sharing light (ReSTIR) took of the last render_frame; 0 without.
    double sharing_seconds() const { return restir_ ? sharing_timer_.seconds() : 0; }
    /// Another picture of the scene as it lies on the device: of this camera, with this size, these layers and this
    /// depth, and `settings.samples` samples from number `first` on. The film stays as it is. Throws Error(OutOfMemory,
    /// DeviceFault).
    RenderResult look_aside(const Camera& camera, const RenderSettings& settings, uint32_t first = 0);
    /// Nodes and triangles that the ray through the middle of each pixel tests, by the tracer of camera rays; empty
    /// where that cannot be told (packets). Throws as look_aside.
    std::vector<RayWork> count_camera_work();
    /// From now on render() and render_frame() break off in the middle of a sample when `*flag` is true, on the CPU
    /// alone; the film then begins anew. Null: never. `flag` outlives the session.
    void abandon_when(const std::atomic<bool>* flag) { abandon_ = queue_.is_cuda() ? nullptr : flag; }
    /// While this is set, an abandoned render() keeps the whole samples that the film had. Each pass then goes through
    /// a second film, which takes as much memory again, so this pays only for samples that take long.
    void keep_samples_when_abandoned(bool keeps) { keeps_samples_ = keeps; }

    const History& history() const { return history_; }
    const Camera& camera() const { return camera_; }
    const RenderSettings& settings() const { return settings_; }

private:
    Film& fit(std::optional<Film>& film, const RenderSettings& settings);
    Film& current_film();
    void begin_film();
    void cut_frames();
    void keep_places();
    void copy_places();
    void take_sample(uint32_t number, const Camera& camera, RenderSettings settings, NoisyFrame& frame,
                     const std::atomic<bool>* abandon = nullptr);
    LightChangeView look_for_change(const RenderSettings& of_light, const ReconstructionSettings& settings);
    void keep_light(uint32_t number, const RenderSettings& of_light, bool goes_on);
    bool take_tracer();
    void fit_trees();
    Restir* restir_for(const RestirSettings& settings, const RenderSettings& of_light);
    void upload(const PreparedScene& scene, uint32_t parts);
    NoisyFrame& fit(std::optional<NoisyFrame>& frame, uint32_t width, uint32_t height);
    void begin_signals();
    void render_signals(Integrator& integrator, uint32_t first, uint32_t count);
    PictureView view_of(const Camera& camera, const RenderSettings& settings);
    MotionTrack motion_of(const Camera& camera, Vec3 centre);
    Integrator& begin(const Camera& camera, const RenderSettings& settings, uint32_t samples,
                      uint64_t picture_number = 0);

    Queue& queue_;
    Camera camera_;
    RenderSettings settings_;
    History history_;
    RenderStats stats_; // but for what stats() reads from the device
    std::optional<double> hidden_back_share_;

    std::shared_ptr<SceneStructures> structures_, prepared_structures_; // as rays meet them; as they were given
    std::vector<PlacedBvh> placed_;                                     // PreparedScene's
    std::vector<DeformedMesh> deformed_; // whose vertices were moved here, and structures_ perhaps have not
    std::optional<SceneOnDevice> scene_; // none after a set_scene that threw
    std::optional<SceneTracer> tracer_;
    FilterTable filter_;
    Buffer<MotionKey> camera_motion_; // while the shutter is open
    std::optional<Film> film_, meter_film_;
    std::optional<Film> pass_film_; // the pass under way, where an abandoned one must leave film_ alone
    std::optional<NoisyFrame> noisy_frame_;
    std::optional<NoisyFrame> features_; // of frames whose light is found at a lower resolution
    std::optional<Reconstruction> reconstruction_;
    std::optional<PictureDenoiser> denoiser_; // of the film's samples
    std::optional<Restir> restir_;            // of frames that ask for it
    RestirSettings restir_settings_;          // of the last frame
    DeviceTimer sharing_timer_;               // its reservoirs, in the last frame
    Buffer<InstanceView> places_before_;      // of instances, in the frame before
    uint32_t instance_count_ = 0;
    bool has_poses_ = false;              // PreparedScene's
    bool has_moved_ = false;              // since the last frame: places_before_ counts
    std::optional<Camera> camera_before_; // of keep_as_before()
    bool scene_has_changed_ = false;      // since the last frame
    std::optional<LightChange> light_change_;
    std::optional<Camera> camera_of_light_; // of the frame before, where light_change_ holds its scene
    uint32_t number_of_light_ = 0;          // that frame's
    PathSettings path_of_light_;            // likewise
    RayCounts frame_rays_;
    SceneTracer::Seconds frame_kind_seconds_;
    uint32_t frame_number_ = 0;                          // of the last frame: its sample's
    bool film_is_old_ = false;                           // holds samples of a picture that is no more asked for
    /// With the settings that it has.
    struct HeldIntegrator {
        std::unique_ptr<Integrator> integrator;
        IntegratorSettings settings;
    };
    HeldIntegrator main_, aside_; // aside_: of other pictures, while main_ has made something for the film's
    uint64_t picture_number_ = 1; // another one for each picture that samples go to the film of
    uint64_t begun_number_ = 0;   // of the picture that main_ has begun; 0: of some other
    const std::atomic<bool>* abandon_ = nullptr;
    bool keeps_samples_ = false;
};

/// Bytes of the device's memory that a session asks for by the time it has rendered `settings.samples` in one call.
std::size_t predicted_bytes(const PreparedScene& scene, const RenderSettings& settings, bool on_cuda);
/// Likewise of one that has made frames in place of the film, but for what following light in a moving scene takes.
std::size_t predicted_frame_bytes(const PreparedScene& scene, const RenderSettings& settings,
                                  const ReconstructionSettings& reconstruction, const RestirSettings& restir,
                                  bool on_cuda);

} // namespace pertev
