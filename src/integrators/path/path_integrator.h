#pragma once

// Path tracing: the one file that orders the stages. Its two bodies, a loop per pixel and a wavefront over queues, call
// the same functions and give the same bytes (tests/consistency/one_picture_test.cpp).

#include <cstdint>
#include <optional>

#include "device/buffer.h"
#include "integrators/integrator.h"
#include "integrators/path/path_queues.h"
#include "integrators/path/path_settings.h"

namespace pertev {

/// Loop is for the CPU, and for tracers that it can walk by itself (SceneTracer::host_trees); else it is Wavefront.
enum class PathBody : uint8_t { Loop, Wavefront };

class PathIntegrator final : public Integrator {
public:
    /// `queue` outlives the integrator. `batch`: most paths in flight of the wavefront.
    PathIntegrator(Queue& queue, const PathSettings& settings, PathBody body, uint32_t batch);

    /// Bytes that begin() takes for so many samples of all pixels together, by the wavefront.
    static std::size_t wavefront_bytes(uint64_t samples, uint32_t batch);

    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    void render(uint32_t first, uint32_t count, Film& film) override;
    RayCounts rays() const override { return rays_; }
    std::size_t bytes() const override;

    /// Counts from the next begin().
    void set_settings(const PathSettings& settings) { settings_ = settings; }

private:
    void render_loop(uint32_t first, uint32_t count, const FilmView& film, const HostTrees& trees);
    void render_wavefront(uint32_t first, uint32_t count, const FilmView& film);
    void trace_batch(uint32_t paths, const FilmView& film);
    void trace_path(PathState path, const FilmView& film, const HostTrees& trees, RayCounts& counts) const;
    const HostTrees* trees_of_loop() const; // null where the body is the wavefront
    PathQueueView path_queue() const;
    ShadowQueueView shadow_queue() const;

    Queue& queue_;
    PathSettings settings_;
    PathBody body_;
    uint32_t batch_;
    PictureView picture_{};
    RayCounts rays_;
    SceneTracer* tracer_ = nullptr;

    // The wavefront's queues, one element a path in flight.
    struct Queues {
        Queues(Queue& queue, uint32_t capacity);
        uint32_t capacity;
        Buffer<Ray> path_rays, shadow_rays;
        Buffer<Uint4> path_ends, shadow_ends;
        Buffer<uint32_t> path_keys, shadow_keys;
        Buffer<Float4> throughput, radiance, contribution, hit_places;
        Buffer<Uint2> samples;
        Buffer<uint32_t> hit_instances; // of path rays, then of shadow rays
        Buffer<uint32_t> active[2];
        Buffer<uint32_t> counts; // next paths, shadow rays
    };
    std::optional<Queues> queues_;
};

} // namespace pertev
