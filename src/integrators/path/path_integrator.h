#pragma once

// Path tracing; this file orders the stages. It has two bodies: a loop in which each CPU thread renders 512 paths
// side by side (integrators/path/path_loop.h), and a wavefront over queues. They call the same functions and give the
// same bytes (tests/consistency/one_picture_test.cpp).
//
// The wavefront runs in rounds (integrators/path/path_queues.h). The host launches rounds without waiting: the number
// of paths of a round stays on the device, and the host reads one round late whether any were left. A GPU runs two
// wavefronts concurrently, or one if there are few paths, each with its shadow rays concurrent with its next bounce,
// so that rays of one kind fill what the last rays of another launch leave idle.
//
// Source: Laine, Karras, Aila, "Megakernels Considered Harmful: Wavefront Path Tracing on GPUs", HPG 2013; ended
// paths are replaced by new ones.

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
    // Additional layers of the film that receive light; may be null. A film of render() has the same layers.
    std::shared_ptr<const LightPathLayers> layers;
    bool is_meter = false; // the picture shows the irradiance of visible surfaces (IrradianceMeter)
    // Rasterization finds primary visibility (render/raster/camera_raster.h), which changes no sample. The camera
    // then has no lens. Only the constructor reads this.
    bool rasterises = false;
};

class PathIntegrator final : public IntegratorBase<PathRequest> {
public:
    /// Makes an integrator. `batch` is the maximum number of paths in flight of all wavefronts, each rounded up to 32;
    /// fewer if their queues would exceed kMaxQueueBytes.
    PathIntegrator(Queue& queue, const PathRequest& settings, bool in_loop, uint32_t batch);

    static constexpr std::size_t kMaxQueueBytes = 600'000'000;
    /// Bytes of a path in flight in all queues, including its shadow ray and its hit.
    static std::size_t bytes_of_path(const PathParts& parts);

    void reserve(const WorkSize& size) override;
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;

private:
    void render_loop(uint32_t first, uint32_t count, const FilmView& film, const HostTrees& trees);
    void render_wavefront(uint32_t first, uint32_t count, const FilmView& film);

    /// Range of samples of a render() call.
    struct Work {
        BeginOrder samples;
        PathJob job;
    };
    PathJob job_for(const FilmView& film) const;
    /// Returns whether camera rays are rasterised, which those with an aim are not.
    bool rasterises(const PathJob& job) const { return raster_.has_value() && job.film.frame.aims == nullptr; }
    /// A round of a wavefront.
    struct Round {
        RoundCounts* counts; // on the device
        uint32_t most;       // the most paths that it can have

        auto pool(RayKind kind) const { return counts->taken + static_cast<int>(kind); }
    };

    struct Wavefront;
    void allocate_wavefronts(uint64_t samples, const PathParts& parts);
    LightPathView layers_for(const FilmView& film) const;
    void launch_rounds(int going, const Work& work);
    void launch_round(Wavefront& wavefront, const Work& work);
    void launch_paths(Wavefront& wavefront, const Work& work, const Round& round);
    template <bool kInBatch>
    void begin_paths(Wavefront& wavefront, const Work& work, const Round& round);
    void launch_light(Wavefront& wavefront, const Work& work, const Round& round);

    std::optional<CameraRaster> raster_; // if it rasterizes

    // The queues of one wavefront, with one element per path in flight.
    struct Wavefront {
        Wavefront(Queue& queue, uint32_t capacity);
        /// Allocates missing memory and keeps the rest.
        void take(Queue& queue, const PathParts& parts);
        /// Paths of round `of_round`; rounds alternate between two sets of arrays.
        PathQueueView paths(uint32_t of_round) const;
        ShadowQueueView shadows() const;
        ListenerQueues listened(uint32_t of_round) const;

        struct Paths {
            Paths(Queue& queue, uint32_t capacity);
            Buffer<Ray> rays;
            Buffer<Uint2> starts;
            Buffer<Float4> throughput, radiance;
            Buffer<Float4> diffuse;  // if frames split light
            Buffer<Uint2> states;    // if there are layers
            Buffer<Uint2> interiors; // if solids are nested
            Buffer<Vec3> normals;    // if lights are selected by a tree
            Buffer<float> passed;    // if shadow rays may pass thin walls
        };
        uint32_t capacity;
        uint32_t in_flight = 0; // maximum for the current call of render()
        Paths sets[2];
        Buffer<Ray> shadow_rays;
        Buffer<Uint2> shadow_starts, shadow_targets;
        Buffer<uint32_t> path_keys, shadow_keys;
        Buffer<Float4> contribution, hit_records;
        Buffer<Float4> shadow_diffuse;          // if frames split light
        Buffer<Float4> shadow_bounce;           // if frames store the first bounce
        Buffer<float> path_times, shadow_times; // if something moves while the shutter is open
        Buffer<Float4> layer_diffuse;           // if there are layers
        Buffer<Uint4> layer_parts;              // if there are layers
        Buffer<uint32_t> hit_instances;
        Buffer<uint32_t> order;     // a round's paths by shading group
        Buffer<RoundCounts> counts; // two rounds alternate
        Readback<HostCounts> seen;  // counts at the start of the last launched round
        uint32_t round = 0;
        HostCounts known = {}; // counts of the round before the last launched one
        bool is_done = false;
        // Shadow rays of a round run concurrently with the rays of the next.
        int path_stream = 0, light_stream = 0;
    };
    std::vector<Wavefront> wavefronts_;
    PathParts parts_; // parts that have been allocated; they never shrink, so alternating frames and pictures
                      // allocate nothing
    Buffer<RenderCounts> render_counts_;
    std::shared_ptr<const LightPathLayers> uploaded_;    // the layers on the device
    std::optional<LightPathsOnDevice> layers_on_device_; // if there are any
};

} // namespace pertev
