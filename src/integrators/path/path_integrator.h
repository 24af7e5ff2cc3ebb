#pragma once

// Path tracing: the one file that orders the stages. Its two bodies, a loop per pixel and a wavefront over queues, call
// the same functions and give the same bytes (tests/consistency/one_picture_test.cpp).

#include <cstdint>

#include "device/buffer.h"
#include "integrators/integrator.h"
#include "integrators/path/path_queues.h"
#include "integrators/path/path_settings.h"

namespace pertev {

/// Seconds that the wavefront's stages took, measured from outside: the queue is waited for after each.
struct StageSeconds {
    double generate = 0, camera_hits = 0, bounce_hits = 0, shade = 0, shadows = 0, film = 0;
};

enum class PathBody : uint8_t { Loop, Wavefront }; // Loop is for the CPU; both run there. CUDA always takes Wavefront.

class PathIntegrator final : public Integrator {
public:
    /// `queue` outlives the integrator. `batch`: most paths in flight of the wavefront.
    PathIntegrator(Queue& queue, const PathSettings& settings, PathBody body, uint32_t batch);

    /// Bytes that begin() takes for a picture of so many samples of all pixels.
    static std::size_t predicted_bytes(uint64_t samples, bool on_cuda, PathBody body, uint32_t batch);

    void begin(const PictureView& picture, uint32_t samples) override;
    void render(uint32_t first, uint32_t count, Film& film) override;
    RayCounts rays() const override { return rays_; }
    std::size_t bytes() const override { return kBytesPerPath * capacity_; }

    /// Counts from the next begin().
    void set_settings(const PathSettings& settings) { settings_ = settings; }
    /// From now on the wavefront's stages are timed, each on its own; slower than a render that is not looked at.
    void time_stages(StageSeconds& seconds) { seconds_ = &seconds; }

private:
    static constexpr std::size_t kBytesPerPath = 8 * sizeof(Float4) + 3 * sizeof(Uint4) + 2 * sizeof(uint32_t);

    void render_loop(uint32_t first, uint32_t count, const FilmView& film);
    void render_wavefront(uint32_t first, uint32_t count, const FilmView& film);
    void trace_batch(uint32_t paths, const FilmView& film);
    void take_queues(uint32_t capacity);
    PathQueueView path_queue() const;
    template <class Stage>
    void run(const char* name, uint32_t count, const Stage& stage, double StageSeconds::*seconds);

    Queue& queue_;
    PathSettings settings_;
    PathBody body_;
    uint32_t batch_;
    PictureView picture_{};
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
