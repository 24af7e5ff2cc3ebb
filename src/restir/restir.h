#pragma once

// ReSTIR: light of the first surface, drawn by resampling from reservoirs that pixels share over the frame and over
// time. A frame's samples leave that light out (render/noisy_frame_view.h, FirstBounceView), and it is added here to
// them. Its stages are the files of this folder that the .cpp launches, each one function for both devices; the rays go
// by the scene's tracer. Without bias, but for what RestirSettings names.
//
// Sources: Bitterli et al., "Spatiotemporal Reservoir Resampling for Real-Time Ray Tracing with Dynamic Direct
// Lighting", SIGGRAPH 2020; Lin et al., "Generalized Resampled Importance Sampling", SIGGRAPH 2022.

#include <cstddef>
#include <cstdint>

#include "render/noisy_frame.h"
#include "render/picture_view.h"
#include "render/reproject.h"
#include "restir/bounce_reservoir.h"
#include "restir/restir_settings.h"
#include "restir/reuse_reservoirs.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// Which numbers a frame's samples are drawn by.
struct SampleNumbers {
    SamplerKind sampler;
    uint32_t sample, seed;
};

class Restir {
public:
    /// `queue` outlives it.
    Restir(Queue& queue, uint32_t width, uint32_t height, RestirLight light);

    /// What follows has nothing to do with what was seen before.
    void cut() { has_history_ = false; }
    /// What the samples of a frame are to leave.
    FirstBounceView first_bounce() const;

    /// Adds to `frame`, which has left first_bounce(), the light that it left. `before`: where things stood in the
    /// frame before. Throws Error(DeviceFault).
    void add(const NoisyFrame& frame, const PictureView& picture, const SampleNumbers& numbers, SceneTracer& tracer,
             const PreviousScene& before, const RestirSettings& settings);

    /// Traced by the last add(). Waits for it.
    uint64_t rays() const;
    /// Which it was made for.
    RestirLight light() const { return light_; }
    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }

private:
    template <class Reservoir>
    void reuse(const SceneView& scene, const PixelSurfaces& here, const PixelSurfaces& there, const Reservoir* own,
               const Reservoir* others, Reservoir* to, float most_count, uint32_t entries, SceneTracer& tracer,
               uint32_t group);
    template <class Reservoir>
    void ask(const SceneView& scene, const PixelSurfaces& surfaces, Reservoir* reservoirs, SceneTracer& tracer,
             uint32_t entry);

    Queue* queue_;
    uint32_t width_, height_, pixels_;
    RestirLight light_;
    bool has_history_ = false;
    CameraRays camera_before_ = {};
    SampleNumbers numbers_before_ = {};
    Buffer<LightPlace> met_;
    Buffer<LightReservoir> reservoirs_; // of this frame's candidates; of the frame, which the next one begins with
    Buffer<BounceReservoir> bounces_;   // the same of indirect light
    Buffer<Float4> bounce_numbers_;     // FirstBounceView's
    Buffer<Float4> seen_before_;        // place and normal of the frame before (NoisyFrameView)
    Buffer<Neighbours> neighbours_;
    Buffer<Shares> shares_;
    Buffer<Ray> rays_;
    Buffer<Uint2> ray_ends_;
    Buffer<uint32_t> ray_words_, ray_counts_; // of each time that rays were traced
    uint32_t traced_ = 0;                     // times, in this frame
};

} // namespace pertev
