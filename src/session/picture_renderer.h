#pragma once

// Takes samples of any picture of a scene on a device, by the integrator of the picture's settings. The integrator
// keeps its queues from one picture to the next, so films, frames and the meter share one PictureRenderer.

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "render/centre_layers.h"
#include "render/filter_table.h"
#include "render/noisy_frame.h"
#include "render/picture_view.h"
#include "render/sample_layers/first_hits.h"
#include "session/device_scene.h"

namespace pertev {

class SharedRender; // session/shared_render.h
class SharedFrames; // session/shared_frames.h

/// Adds targets to a new film, by Film::hold.
using AddTargets = std::function<void(Film&)>;

Film make_film(Queue& queue, const RenderSettings& settings);
/// Returns the bytes that a film of these settings takes.
std::size_t predicted_film_bytes(const RenderSettings& settings);
/// Returns `film` if it fits a picture of these settings, else replaces it by a new one without samples, for which
/// `add` is called.
Film& fit_film(Queue& queue, std::optional<Film>& film, const RenderSettings& settings, const AddTargets& add = {});
/// Returns `frame` if it fits single samples of the scene at this size, else replaces it by a new one.
NoisyFrame& fit_frame(const DeviceScene& scene, std::optional<NoisyFrame>& frame, uint32_t width, uint32_t height);
bool is_film_of(const Film& film, const RenderSettings& settings);

class PictureRenderer {
public:
    /// Makes a renderer of `scene`, which outlives it.
    explicit PictureRenderer(DeviceScene& scene)
        : scene_(scene), filter_(scene.queue()), centres_(scene.queue()), first_hits_(scene.queue()) {}

    DeviceScene& scene() { return scene_; }
    Queue& queue() { return scene_.queue(); }
    PictureView view_of(const Camera& camera, const RenderSettings& settings);
    /// Uploads a scene, or changed parts of it, by DeviceScene::set and update. Devices that share the pictures take it
    /// at their next render.
    void set_scene(const PreparedScene& scene, const RenderSettings& settings);
    void update_scene(const PreparedScene& scene, uint32_t parts, const RenderSettings& settings);

    /// Lets films that are made from now on be rendered by other devices too; `sharing` outlives them.
    void share(SharedRender& sharing) { sharing_ = &sharing; }
    void stop_sharing() { sharing_ = nullptr; }        // films that were made before are of no use then
    SharedRender* sharing() const { return sharing_; } // null: this device renders alone
    /// Lets real-time frames be rendered by other devices too. Must be called before the first frame.
    void share_frames(SharedFrames& sharing) { sharing_frames_ = &sharing; }
    SharedFrames* sharing_frames() const { return sharing_frames_; }
    Queue& film_queue();

    /// Returns an integrator that is ready to add `samples` samples of this picture, and that nothing stops. Its
    /// precomputed data is kept if `number`, which new_number() returned, equals that of the previous begin(). 0
    /// stands for a picture whose samples are not continued. Throws Error(BadInput) if the camera or the shutter is
    /// incompatible with the settings, and Error(OutOfMemory, DeviceFault).
    Integrator& begin(const Camera& camera, const RenderSettings& settings, uint32_t samples, uint64_t number = 0);
    /// Returns an integrator for a view that the caller has made and whose cameras the caller has checked, such as that
    /// of a batch.
    Integrator& begin(const PictureView& picture, const RenderSettings& settings, uint32_t samples,
                      uint64_t number = 0);
    /// Finds the layers at the centres of pixels, if the film has any. Throws Error(OutOfMemory, DeviceFault).
    void find_centres(const Camera& camera, const RenderSettings& settings, const Film& film);
    CentreLayers& centres() { return centres_; }
    /// Adds the first hits and the number of samples that `film` has just taken to its layers of them, if the settings
    /// have any (FirstHits). Throws Error(OutOfMemory, DeviceFault).
    void add_first_hits(const Camera& camera, const RenderSettings& settings, SampleRange samples, const Film& film);
    /// Returns a number for a picture whose samples continue over several begin() calls. Pictures in between use
    /// another integrator if the one of the latest such picture has precomputed data.
    uint64_t new_number() { return ++last_number_; }

    /// Renders `settings.samples` samples from `first` on into a separate film. Throws as begin().
    RenderResult render_separately(const Camera& camera, const RenderSettings& settings, uint32_t first = 0);
    /// Returns the nodes and triangles that the ray through the middle of each pixel tests, by the tracer of camera
    /// rays; nothing for packets. Throws Error(OutOfMemory, DeviceFault).
    std::vector<RayWork> count_camera_work(const Camera& camera, const RenderSettings& settings);

private:
    /// Lets other devices that render with this one take the change.
    void update_other_devices(const PreparedScene& scene, uint32_t parts);
    MotionTrack motion_of(const Camera& camera, Vec3 centre);

    DeviceScene& scene_;
    SharedRender* sharing_ = nullptr;
    SharedFrames* sharing_frames_ = nullptr;
    FilterTable filter_;
    CentreLayers centres_;
    FirstHits first_hits_;
    Buffer<MotionKey> camera_motion_; // used while the shutter is open
    struct HeldIntegrator {
        std::unique_ptr<Integrator> integrator;
        IntegratorSettings settings; // settings of the integrator
    };
    HeldIntegrator main_, aside_; // aside_ renders other pictures while main_ holds precomputed data of the film's
    uint64_t last_number_ = 0;
    uint64_t begun_number_ = 0; // number of the picture that main_ has begun
};

} // namespace pertev
