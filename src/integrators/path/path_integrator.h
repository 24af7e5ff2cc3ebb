#pragma once

// Path tracing: the one file that orders the stages. Its two bodies, a loop in which each thread of the CPU takes 128
// paths side by side to their ends (integrators/path/path_loop.h) and a wavefront over queues, call the same functions
// and give the same bytes (tests/consistency/one_picture_test.cpp).
//
// The wavefront goes round by round (integrators/path/path_queues.h). The host gives rounds to the device without
// waiting for one: how many paths a round has stays there, and the host reads one round late whether any were left. Two
// wavefronts go side by side on a GPU, or one where there are few paths, each with its shadow rays beside its next
// bounce: rays of one kind fill what the last rays of another's launch leave idle.
//
// Source: Laine, Karras, Aila, "Megakernels Considered Harmful: Wavefront Path Tracing on GPUs", HPG 2013, whose pool
// of paths is refilled as they end.

#include <memory>
#include <optional>
#include <vector>

#include "device/buffer.h"
#include "device/readback.h"
#include "integrators/integrator_base.h"
#include "integrators/path/path_listener.h"
#include "integrators/path/path_queues.h"
#include "integrators/path/path_settings.h"
#include "render/begin_order.h"
#include "render/light_paths/light_paths_on_device.h"
#include "render/raster/camera_raster.h"

namespace pertev {

/// The settings of a path-traced render.
struct PathRequest {
    PathSettings path;
    // Light is added to these layers of the film too. They may be null. A film of render() has as many.
    std::shared_ptr<const LightPathLayers> layers;
    bool is_meter = false; // the picture shows the irradiance of what the camera sees (IrradianceMeter)
    // Rasterisation finds what the camera sees (render/raster/camera_raster.h), which changes no sample. The camera
    // then has no lens. Only the constructor reads this.
    bool rasterises = false;
};

class PathIntegrator final : public IntegratorBase<PathRequest> {
public:
    /// `batch`: most paths in flight of the wavefronts together, rounded up to 32 each; fewer where their queues would
    /// pass kMostQueueBytes.
    PathIntegrator(Queue& queue, const PathRequest& settings, bool in_loop, uint32_t batch);

    static constexpr std::size_t kMostQueueBytes = 600'000'000;
    /// Of a path in flight in all queues, its shadow ray's and its hit's among them.
    static std::size_t bytes_of_path(const PathParts& parts);

    void reserve(const WorkSize& size) override;
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;

private:
    void render_loop(uint32_t first, uint32_t count, const FilmView& film, const HostTrees& trees);
    void render_wavefront(uint32_t first, uint32_t count, const FilmView& film);

    /// Samples that render() makes.
    struct Work {
        BeginOrder samples;
        PathJob job;
    };
    PathJob job_for(const FilmView& film) const;
    struct Wavefront;
    void take_wavefronts(uint64_t samples, const PathParts& parts);
    LightPathView layers_for(const FilmView& film) const;
    void give_rounds(int going, const Work& work);
    void give_round(Wavefront& wavefront, const Work& work);

    std::optional<CameraRaster> raster_; // where it rasterises

    // The queues of one wavefront, one element a path in flight.
    struct Wavefront {
        Wavefront(Queue& queue, uint32_t capacity);
        /// Memory for what is not there yet. It is kept.
        void take(Queue& queue, const PathParts& parts);
        /// Of a round: rounds read and write two sets of arrays in turns.
        PathQueueView paths(uint32_t of_round) const;
        ShadowQueueView shadows() const;
        ListenerQueues listened(uint32_t of_round) const;

        struct Paths {
            Paths(Queue& queue, uint32_t capacity);
            Buffer<Ray> rays;
            Buffer<Float4> throughput, radiance;
            Buffer<Float4> diffuse; // where frames split light
            Buffer<Uint2> states;   // where there are layers
        };
        uint32_t capacity;
        uint32_t in_flight = 0; // at most, of what is rendered now
        Paths sets[2];
        Buffer<Ray> shadow_rays;
        Buffer<Uint2> path_starts, shadow_starts, shadow_targets;
        Buffer<uint32_t> path_keys, shadow_keys;
        Buffer<Float4> contribution, hit_places;
        Buffer<Float4> shadow_diffuse;          // where frames split light
        Buffer<Float4> shadow_sent;             // where frames tell their first bounce
        Buffer<float> path_times, shadow_times; // where something moves while the shutter is open
        Buffer<Float4> layer_diffuse;           // where there are layers
        Buffer<Uint4> layer_parts;              // likewise
        Buffer<uint32_t> hit_instances;
        Buffer<RoundCounts> counts; // of two rounds in turns
        Readback<SeenCounts> seen;  // of the round given last, at its start
        uint32_t round = 0;
        SeenCounts known = {}; // of the round before the last one given
        bool is_done = false;
        // Shadow rays of a round and the rays of the next go side by side.
        int path_stream = 0, light_stream = 0;
    };
    std::vector<Wavefront> wavefronts_;
    PathParts parts_; // that they have: all that were ever asked for, so that frames and pictures in turns take none
    Buffer<RenderCounts> render_counts_;
    std::shared_ptr<const LightPathLayers> uploaded_;    // the layers on the device
    std::optional<LightPathsOnDevice> layers_on_device_; // where there are some
};

} // namespace pertev
