#pragma once

// The seam between an algorithm of light transport and what lives around it: sessions, the command line, viewers. Each
// algorithm has a folder of its own and includes no other; integrators/kinds/make_integrator.h knows them all.

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "render/film_view.h"
#include "render/picture_view.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// Rays traced, by kind.
struct RayCounts {
    uint64_t camera = 0, bounce = 0, shadow = 0;
    uint64_t total() const { return camera + bounce + shadow; }
};
inline RayCounts operator+(const RayCounts& a, const RayCounts& b) {
    return {a.camera + b.camera, a.bounce + b.bounce, a.shadow + b.shadow};
}

/// The sizes that decide, together with the settings, how much of a device's memory an integrator takes.
struct WorkSize {
    uint32_t width = 0, height = 0; // of the picture, in pixels
    uint32_t samples = 1;           // of each pixel in one call of render()
    uint64_t triangles = 0;         // in all instances of the scene
    bool walks_on_host = false;     // threads of the CPU can trace rays without the tracer (SceneTracer::host_trees)
    bool has_times = false;         // something moves while the shutter is open
    bool splits_light = false;      // a frame (FilmView::frame) keeps diffuse light and the rest apart
    bool tells_bounce = false;      // a frame records its first bounce

    uint64_t pixels() const { return uint64_t(width) * height; }
    uint64_t all() const { return pixels() * samples; }
};
inline WorkSize size_of(const PictureView& picture, const SceneTracer& tracer, uint32_t samples) {
    return {.width = picture.camera.width,
            .height = picture.camera.height,
            .samples = samples,
            .triangles = picture.scene.triangle_count,
            .walks_on_host = tracer.host_trees() != nullptr,
            .has_times = picture.scene.motions.is_there()};
}

class Integrator {
public:
    virtual ~Integrator() = default;

    /// Takes the memory for work of this size and keeps what it holds already if that is enough. begin() calls it. A
    /// dry run (Queue::make_dry_run) calls it alone, to predict what begin() takes. Throws Error(OutOfMemory).
    virtual void reserve(const WorkSize& size) = 0;
    /// Returns an upper bound of the bytes that work of this size takes of the host's memory besides.
    virtual std::size_t most_host_bytes(const WorkSize& size) const {
        static_cast<void>(size);
        return 0;
    }

    /// From now on samples are of this picture, and `tracer` traces their rays. Both stay as they are until the next
    /// begin(). Memory is taken for `samples` of each pixel (WorkSize); more may be asked for. Another camera takes
    /// none. Throws Error(OutOfMemory).
    virtual void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) = 0;

    /// Said before begin(): it will be given the picture of the begin() before it, unchanged, and so are the settings.
    /// What was found out for that picture may be kept.
    virtual void expect_same_picture() {}
    /// Whether something was found out for the picture begun that another picture's begin() would throw away.
    virtual bool has_made() const { return false; }

    /// Makes what all samples of the picture begun need, where that is not there; render() does so where this was not
    /// called. Asks `goes_on` on the caller's thread, before it begins and every tenth of a second or so (on a GPU
    /// between passes of kernels), with the share of it that is done, [0, 1], as far as that is known; it never falls.
    /// Returns false, and there is nothing, once that is false. Throws Error(DeviceFault), and what `goes_on` throws.
    virtual bool make_ready(const std::function<bool(double share)>& goes_on) {
        static_cast<void>(goes_on); // there is nothing to make
        return true;
    }

    /// Adds samples [first, first + count) of every pixel to `film`, which has the picture's size, and returns when
    /// that is done. A film view of a noisy frame (render/noisy_frame.h) takes one sample alone. A sample is a function
    /// of the picture, the settings and its number alone, so work may be split any way. Throws Error(DeviceFault).
    virtual void render(uint32_t first, uint32_t count, const FilmView& film) = 0;

    /// As render(), but where that takes long for a few samples it asks `goes_on` on the caller's thread every tenth of
    /// a second or so, and ends once that is false. Returns how many of the samples, from the first on, are in the
    /// film, whole; nothing is there of the others. Throws what render() and `goes_on` do.
    virtual uint32_t render_while(uint32_t first, uint32_t count, const FilmView& film,
                                  const std::function<bool()>& goes_on) {
        static_cast<void>(goes_on); // who asks for few samples waits for them
        render(first, count, film);
        return count;
    }

    /// Where it can, render() returns at once when `*flag` is true, and the film is then to be thrown away. Null:
    /// never.
    virtual void abandon_when(const std::atomic<bool>*) {}

    /// Since begin().
    virtual RayCounts rays() const = 0;
};

} // namespace pertev
