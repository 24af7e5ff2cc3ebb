#pragma once

// Path tracing: the one file that orders the stages. Its two bodies, a loop per pixel and a wavefront over queues, call
// the same functions and give the same bytes (tests/consistency/one_picture_test.cpp).

#include <cstdint>

#include "device/buffer.h"
#include "integrators/path/generate_path.h"
#include "integrators/path/path_queues.h"
#include "render/film.h"
#include "render/scene_view.h"

namespace pertev {

/// Rays traced, by kind.
struct RayCounts {
    uint64_t camera = 0, bounce = 0, shadow = 0;
    uint64_t total() const { return camera + bounce + shadow; }
};

/// Seconds that the wavefront's stages took, measured from outside: the queue is waited for after each.
struct StageSeconds {
    double generate = 0, camera_hits = 0, bounce_hits = 0, shade = 0, shadows = 0, film = 0;
};

enum class PathBody : uint8_t { Loop, Wavefront }; // Loop is for the CPU; both run there

class PathRenderer {
public:
    /// `scene` and `queue` outlive the renderer. `batch`: paths in flight of the wavefront.
    PathRenderer(Queue& queue, const SceneView& scene, const Camera& camera, PixelFilter filter, float filter_radius,
                 const PathSettings& settings, uint32_t width, uint32_t height, PathBody body,
                 uint32_t batch = 1u << 22);

    /// Device memory that the wavefront takes for each path in flight.
    static constexpr std::size_t kBytesPerPath = 8 * sizeof(Float4) + 3 * sizeof(Uint4) + 2 * sizeof(uint32_t);

    /// Adds samples [first, first + count) of every pixel to `film` and returns when that is done. Throws
    /// Error(DeviceFault) when the GPU fails.
    void render(uint32_t first, uint32_t count, Film& film);

    const RayCounts& rays() const { return rays_; }

    /// Share of the camera's rays, in [0, 1], that pass the back of a surface that is not double sided; of 4096 spread
    /// over the picture, which no setting changes. Costs nothing where there is no such surface. Throws
    /// Error(DeviceFault).
    double hidden_back_share();

    /// From now on the wavefront's stages are timed, each on its own; slower than a render that is not looked at.
    void time_stages(StageSeconds& seconds) { seconds_ = &seconds; }

private:
    void render_loop(uint32_t first, uint32_t count, const FilmView& film);
    void render_wavefront(uint32_t first, uint32_t count, const FilmView& film);
    void trace_batch(uint32_t paths, const FilmView& film);
    PathQueueView path_queue() const;
    template <class Stage>
    void run(const char* name, uint32_t count, const Stage& stage, double StageSeconds::*seconds);

    Queue& queue_;
    SceneView scene_;
    PathSettings settings_;
    uint32_t width_, height_;
    PathBody body_;
    Buffer<float> filter_table_;
    PathCamera camera_;
    RayCounts rays_;
    StageSeconds* seconds_ = nullptr;

    // The wavefront's queues, one element a path in flight.
    uint32_t capacity_ = 0;
    Buffer<Float4> path_floats_[4], shadow_floats_[3], hit_floats_;
    Buffer<Uint4> path_ids_, shadow_ids_, hit_ids_;
    Buffer<uint32_t> active_[2];
    Buffer<uint32_t> counts_; // next paths, shadow rays
};

} // namespace pertev
