#pragma once

// The interface between light-transport algorithms and their users: sessions, the command line, viewers. Each
// algorithm has its own folder and includes no other; integrators/kinds/make_integrator.h knows them all.

#include <cstddef>
#include <cstdint>
#include <functional>

#include "base/sink.h"
#include "render/film_view.h"
#include "render/picture_view.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// Number of rays traced, by kind.
struct RayCounts {
    uint64_t camera = 0, bounce = 0, shadow = 0;
    uint64_t total() const { return camera + bounce + shadow; }
};
inline RayCounts operator+(const RayCounts& a, const RayCounts& b) {
    return {a.camera + b.camera, a.bounce + b.bounce, a.shadow + b.shadow};
}
inline RayCounts operator-(const RayCounts& a, const RayCounts& b) {
    return {a.camera - b.camera, a.bounce - b.bounce, a.shadow - b.shadow};
}

/// Sizes that determine, with the settings, the device memory of an integrator.
struct WorkSize {
    uint32_t width = 0, height = 0; // pixels of the picture
    uint32_t samples = 1;           // samples per pixel in one call of render()
    uint64_t triangles = 0;         // in all instances of the scene
    bool traverses_on_host = false; // CPU threads can trace rays without the tracer (SceneTracer::host_trees)
    bool has_times = false;         // something moves while the shutter is open
    bool splits_light = false;      // a frame (FilmView::frame) separates diffuse light from the rest
    bool records_bounce = false;    // a frame records its first bounce
    bool has_interiors = false;     // solids lie in each other (SceneView::nesting)
    bool has_media = false;         // a medium fills any part of space
    bool has_thin_walls = false;    // shadow rays may pass thin walls (SceneView::thin_walls)
    uint32_t tree_lights = 0;       // lights that a tree holds (LightTreeView::light_count)

    uint64_t pixels() const { return uint64_t(width) * height; }
    uint64_t all() const { return pixels() * samples; }
};
/// Completes `size` by what the scene determines. The view may be that of a dry run.
inline WorkSize with_scene(WorkSize size, const SceneView& scene) {
    size.triangles = scene.triangle_count;
    size.has_times = scene.motions.is_there();
    size.has_interiors = scene.nesting.is_there();
    size.has_media = scene.has_media != 0;
    size.has_thin_walls = scene.thin_walls.is_there();
    size.tree_lights = scene.lights.tree.light_count;
    return size;
}
inline WorkSize size_of(const PictureView& picture, const SceneTracer& tracer, uint32_t samples) {
    return with_scene({.width = picture.camera.width,
                       .height = picture.camera.height,
                       .samples = samples,
                       .traverses_on_host = tracer.host_trees() != nullptr},
                      picture.scene);
}

class Integrator {
public:
    virtual ~Integrator() = default;

    /// Allocates memory for work of this size, unless the integrator's memory suffices. begin() calls it. A dry run
    /// (Queue::make_dry_run) calls only this, to predict the memory of begin(). Throws Error(OutOfMemory).
    virtual void reserve(const WorkSize& size) = 0;
    /// Returns the bytes of the host's memory that reserve() has allocated besides the queue's.
    virtual std::size_t host_bytes() const { return 0; }

    /// Starts a picture: samples are taken of `picture`, and `tracer` traces their rays. Both must not change until
    /// the next begin(). Memory is allocated for `samples` per pixel (WorkSize); render() may be called for more. A
    /// change of camera alone allocates nothing. Throws Error(OutOfMemory).
    virtual void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) = 0;

    /// Announces that the next begin() gets the same picture and settings as the last one, so that precomputed data
    /// may be kept.
    virtual void expect_same_picture() {}
    /// Returns whether the current picture has precomputed data that begin() of another picture would discard.
    virtual bool has_made() const { return false; }

    /// Precomputes what all samples of the current picture need, if it is missing; otherwise render() does it. Calls
    /// `goes_on` on the caller's thread, before it starts and about every tenth of a second (on a GPU between passes
    /// of kernels), with the share that is done, in [0, 1], as far as known; it never falls. Once `goes_on` returns
    /// false, it discards the data and returns false. Throws Error(DeviceFault), and what `goes_on` throws.
    virtual bool prepare(const std::function<bool(double share)>& goes_on) {
        static_cast<void>(goes_on); // nothing to precompute
        return true;
    }

    /// Adds samples [first, first + count) of every pixel of `film`, a window of the picture or all of it, and returns
    /// when they are done. The film view of a noisy frame (render/noisy_frame.h) takes only one sample. A sample
    /// depends only on the picture, the settings, its pixel and its number, so work may be split in any way. Throws
    /// Error(DeviceFault), and std::logic_error for a frame if the integrator makes none (makes_frames).
    virtual void render(uint32_t first, uint32_t count, const FilmView& film) = 0;

    /// Renders like render(), but if few samples take long, it calls `goes_on` on the caller's thread about every
    /// tenth of a second and stops once that returns false. Returns how many samples, from the first on, are complete
    /// in the film; it contains nothing of the others. Throws what render() and `goes_on` do.
    virtual uint32_t render_while(uint32_t first, uint32_t count, const FilmView& film,
                                  const std::function<bool()>& goes_on) {
        static_cast<void>(goes_on); // few samples are rendered to the end
        render(first, count, film);
        return count;
    }

    /// Lets render() return early once `sink` stops, if it can; the film must then be discarded. Null: never.
    virtual void stop_with(Sink* sink) { static_cast<void>(sink); }

    /// Number of rays traced since begin().
    virtual RayCounts rays() const = 0;
};

} // namespace pertev
