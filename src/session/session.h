#pragma once

// Rendering that lives over time: one object for as long as there is something to render. A facade over parts that
// stand alone: the scene on a device (device_scene.h), the film (film_render.h), frames (frame_sequence.h), the meter
// (meter_exposure.h), which share integrators (picture_renderer.h). What does not change is not uploaded, allocated or
// built again.
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

#include <algorithm>
#include <optional>

#include "base/limits.h"
#include "device_scene/ray_queue.h"
#include "session/film_render.h"
#include "session/frame_sequence.h"
#include "session/meter_exposure.h"
#include "session/sink.h"

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

    /// As the constructor. When this throws there is no scene, and the next set_scene must come before anything is
    /// rendered or metered.
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

    /// Adds `samples` samples to each pixel, or fewer, as FilmRender::render says.
    uint32_t render(uint32_t samples, const FilmRender::KeepGoing& keep_going = {}) {
        const uint32_t first = film_.samples().end;
        return film_.render({first, first + std::min(samples, kMaxSamplesPerPixel - first)}, keep_going);
    }
    /// Renders likewise, tells `sink` how far it is, and ends when that is cancelled.
    uint32_t render(uint32_t samples, Sink& sink);
    void keep_samples_when_abandoned(bool keeps) { film_.keep_samples_when_abandoned(keeps); }

    /// Returns the film of the present picture. It is all zero without samples.
    const Film& film() { return film_.film(); }
    Image picture() { return film_.picture(); }
    std::optional<Image> denoised() { return film_.denoised(); }
    std::vector<FilmLayer> layers() { return film_.layers(); }
    RenderStats stats() { return film_.stats(); }
    /// Brings the picture to the host as a display shows it, times 2^exposure_stops: tone_map_image of picture().
    void display(ToneMap tone_map, float exposure_stops);
    /// Returns what the last display() brought.
    Rgba8Image displayed() { return film_.film().displayed(); }
    /// Returns picture, denoised picture, layers, ids, motion vectors and stats together.
    RenderResult result();
    /// Returns exposure for the present picture (Meter::stops).
    float meter(ToneMap tone_map) { return meter_.stops(camera(), settings(), tone_map); }

    /// Renders the next frame of a sequence, by FrameSequence::render. The film stays as it is.
    bool render_frame(uint32_t number, const ReconstructionSettings& reconstruction,
                      const RestirSettings& restir = {}) {
        return frames_.render(number, camera(), settings(), reconstruction, restir);
    }
    FrameSequence& frames() { return frames_; }
    Reconstruction& frame() { return frames_.reconstruction(); }
    RenderResult frame_result() { return frames_.result(camera(), settings()); }
    /// From now on motion vectors (kAovMotion) are from the scene and camera as they are now.
    void keep_as_before() { frames_.keep_as_before(camera()); }
    Image motion() { return frames_.motion(camera(), settings()); }

    /// Renders another picture of the scene, by PictureRenderer::render_aside. The film stays as it is.
    RenderResult look_aside(const Camera& camera, const RenderSettings& settings, uint32_t first = 0) {
        return pictures_.render_aside(camera, settings, first);
    }
    /// Returns the nodes and triangles that the ray through the middle of each pixel tests, by the tracer of camera
    /// rays; nothing if that cannot be told (packets). Throws Error(OutOfMemory, DeviceFault).
    std::vector<RayWork> count_camera_work();
    void abandon_when(const std::atomic<bool>* flag) { pictures_.abandon_when(flag); }

    History history() const { return {film_.samples().end, previous_camera_, cuts_}; }
    const Camera& camera() const { return film_.camera(); }
    const RenderSettings& settings() const { return film_.settings(); }

private:
    DeviceScene scene_;
    PictureRenderer pictures_;
    FilmRender film_;
    FrameSequence frames_;
    Meter meter_;
    std::optional<Camera> previous_camera_;
    uint64_t cuts_ = 0;
};

/// Bytes of the device's memory that a session asks for by the time it has rendered `settings.samples` in one call.
std::size_t predicted_bytes(const PreparedScene& scene, const RenderSettings& settings, bool on_cuda);
/// Likewise of one that has made frames in place of the film, but for what following light in a moving scene takes.
std::size_t predicted_frame_bytes(const PreparedScene& scene, const RenderSettings& settings,
                                  const ReconstructionSettings& reconstruction, const RestirSettings& restir,
                                  bool on_cuda);

} // namespace pertev
