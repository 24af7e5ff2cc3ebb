#pragma once

// A session renders a scene over time. It is a facade over independent parts: the scene on a device (device_scene.h),
// the film (film_render.h), frames (frame_sequence.h) and the meter (meter_exposure.h), which share integrators
// (picture_renderer.h). Whatever does not change is not uploaded, allocated or built again.
//
// Samples accumulate in the film until the picture changes, which restarts the film. These calls do that:
//   set_scene     always. Uploads the scene; allocates for its trees and for parts that are larger than before, nothing
//                 for film and queues.
//   update_scene  always. Uploads only the given parts, changed trees, and joints and weights of deforming meshes,
//                 whose vertices and trees are computed on the device. Allocates for parts that are larger than before.
//   set_camera    if the camera differs. Uploads and allocates nothing.
//   set_settings  if the picture differs (same_picture). Another size or other layers allocate a new film at the next
//                 render, and larger queues if needed; another tracer uploads its structure. Anything else allocates
//                 nothing. Another frame_depth is a cut of the frames only, and the film stays.
//   set_targets   always. Allocates a new film at the next render.
//   cut           always.
// The picture of n samples equals that of a new session, to the byte, whatever came before; so does one of a samples
// with b added. One thread at a time may use a session.

#include <algorithm>
#include <optional>

#include "base/limits.h"
#include "base/sink.h"
#include "device_scene/ray_queue.h"
#include "session/film_render.h"
#include "session/meter_exposure.h"
#include "session/moving_frames.h"

namespace pertev {

/// Relation of later frames to earlier ones.
struct History {
    uint32_t samples = 0; // whole samples of all pixels in the film since its start
    /// The camera of the last samples before the current camera's; none since the last cut.
    std::optional<Camera> previous_camera;
    /// Number of changes that invalidate earlier results: all that restart the film, except set_camera.
    uint64_t cuts = 0;
};

class Session {
public:
    /// Uploads `scene`, which need not outlive the call, nor need the Scene from which it was made. `queue` outlives
    /// the session. Throws Error(OutOfMemory, DeviceFault), and what set_settings throws.
    Session(Queue& queue, const PreparedScene& scene, const Camera& camera, const RenderSettings& settings);

    /// Replaces the scene and throws as the constructor. If it throws there is no scene, and set_scene must succeed
    /// before anything is rendered or metered.
    void set_scene(const PreparedScene& scene);
    /// Updates the scene after a change: uploads only `parts` (ScenePart) of `scene`, which must not differ otherwise
    /// from the current one. It is no cut: the next samples are a later frame of the same sequence. Throws as
    /// set_scene.
    void update_scene(const PreparedScene& scene, uint32_t parts);
    void set_camera(const Camera& camera);
    /// Changes the settings. Throws what check_integrator does, and Error(BadInput) without any effect if the device
    /// has no such tracer; Error(OutOfMemory, OverLimit) if another tracer's structure cannot be made: set_settings
    /// must then succeed before anything is rendered.
    void set_settings(const RenderSettings& settings);
    /// Sets targets of the session's films, as FilmRender::set_targets.
    void set_targets(AddTargets add);
    /// Discards everything that was rendered before (for a camera that jumps, or a measurement that restarts).
    void cut();

    /// Adds up to `samples` samples to each pixel; see FilmRender::render.
    uint32_t render(uint32_t samples, Sink& sink = nobody()) {
        const uint32_t first = film_.samples().end;
        return render(SampleRange{first, first + std::min(samples, kMaxSamplesPerPixel - first)}, sink);
    }
    uint32_t render(SampleRange range, Sink& sink = nobody()) { return film_.render(range, sink); }
    uint32_t render(uint32_t samples, Sink&& sink) { return render(samples, sink); }
    FilmRender& film_render() { return film_; }
    void interrupt_passes(bool leaves) { film_.interrupt_passes(leaves); }

    /// Returns the film of the current picture. It is all zero before the first sample.
    const Film& film() { return film_.film(); }
    Image picture() { return film_.picture(); }
    std::optional<Image> denoised() { return film_.denoised(); }
    std::vector<FilmLayer> layers() { return film_.layers(); }
    RenderStats stats() { return film_.stats(); }
    const RayCounts& rays() const { return film_.rays(); }
    void display(ToneMap tone_map, float exposure_stops) { film_.display(tone_map, exposure_stops); }
    Rgba8Image displayed() { return film_.film().displayed(); }
    /// Returns picture, denoised picture, layers, ids, motion vectors and stats together.
    RenderResult result();
    float meter(ToneMap tone_map) { return meter_.stops(camera(), settings(), tone_map); }
    /// Returns what the light meter sees (metered_light). Throws as meter().
    Image metered_light() { return meter_.light(camera(), settings()); }

    /// Renders the next frame of a sequence by FrameSequence::render. The film stays as it is.
    bool render_frame(uint32_t number, const ReconstructionSettings& reconstruction, const RestirSettings& restir = {},
                      Sink& sink = nobody()) {
        return frames_.render(number, camera(), settings(), reconstruction, restir, sink);
    }
    MovingFrames& frames() { return frames_; }
    Reconstruction& frame() { return frames_.reconstruction(); }
    RenderResult frame_result() { return frames_.result(camera(), settings()); }
    /// Makes the present scene and camera the reference of motion vectors (kAovMotion).
    void store_previous() { frames_.store_previous(camera()); }
    Image motion();

    /// Renders another picture of the scene, of samples from `first` on. The film stays as it is.
    RenderResult render_separately(const Camera& camera, const RenderSettings& settings, uint32_t first = 0) {
        return render_with_steps(pictures_, camera, settings, first);
    }
    std::vector<RayWork> count_camera_work() { return pictures_.count_camera_work(camera(), settings()); }

    PictureRenderer& pictures() { return pictures_; } // renders others of the scene, such as batches (BatchRender)
    History history() const { return {film_.samples().end, previous_camera_, cuts_}; }
    const Camera& camera() const { return film_.camera(); }
    const RenderSettings& settings() const { return film_.settings(); }

private:
    DeviceScene scene_;
    PictureRenderer pictures_;
    FilmRender film_;
    MovingFrames frames_;
    Meter meter_;
    std::optional<Camera> previous_camera_;
    uint64_t cuts_ = 0;
};

/// Renders `settings.samples` samples in a session of their own, or fewer when time is over or `sink` stops. Throws
/// Error(OutOfMemory, DeviceFault).
RenderResult render_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera,
                            const RenderSettings& settings, Sink& sink = nobody());

} // namespace pertev
