#pragma once

// ReSTIR: light at the first surface by resampling from reservoirs that pixels share over the frame and over time. A
// frame's samples omit that light (render/noisy_frame_view.h, FirstBounceView), and it is added to them here. The
// stages are the files of this folder, each one function for both devices; the scene's tracer traces the rays. It is
// unbiased except for what RestirSettings names.
//
// Sources: Bitterli et al., "Spatiotemporal Reservoir Resampling for Real-Time Ray Tracing with Dynamic Direct
// Lighting", SIGGRAPH 2020; Lin et al., "Generalized Resampled Importance Sampling", SIGGRAPH 2022.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/noisy_frame.h"
#include "render/picture_view.h"
#include "render/reproject.h"
#include "render/row_exchange.h"
#include "restir/bounce_reservoir.h"
#include "restir/restir_settings.h"
#include "restir/reuse_reservoirs.h"
#include "shading/light_selection.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// The numbers that determine the random numbers of a frame's samples, and whether their textures are filtered.
struct SampleNumbers {
    SamplerKind sampler;
    uint32_t sample, seed;
    bool filters;
};

class Restir {
public:
    /// Allocates memory for frames of this size of scenes with this shading variant; `queue` outlives it.
    Restir(Queue& queue, uint32_t width, uint32_t height, RestirLight light, ShadingVariant variant);

    /// Discards the history, because the next frame is unrelated to it.
    void cut() { has_history_ = false; }
    bool has_history() const { return has_history_; }
    /// Lets the next frames make this device's rows alone, as Reconstruction::share.
    void share(RowExchange* others) { others_ = others; }
    /// Arrays of the last frame that the next one needs; none after a cut.
    std::vector<RowArray> rows_of_history() const;
    /// Returns whether `arrays`, of the right sizes but from an untrusted file, name only triangles of the scene.
    /// `triangle_counts` are those of its instances.
    static bool are_of_scene(std::span<const std::vector<std::byte>> arrays, std::span<const uint32_t> triangle_counts);
    /// Continues after a frame that other reservoirs made; the caller then fills rows_of_history().
    void begin_after(const CameraRays& camera, const SampleNumbers& numbers) {
        camera_before_ = camera, numbers_before_ = numbers, has_history_ = true;
    }
    /// Arrays in which the samples of a frame leave their first bounce.
    FirstBounceView first_bounce() const;

    /// Adds to `noisy` the light that its samples omitted; they must have filled first_bounce(). `before` has the
    /// positions in the previous frame, `change` the light that has changed since. `selection` is that of the samples'
    /// lights, and of the candidates. Throws Error(DeviceFault).
    void add(const NoisyFrame& noisy, const PictureView& picture, const SampleNumbers& numbers, SceneTracer& tracer,
             const PreviousScene& before, const ChangedLight& change, const RestirSettings& settings,
             LightSelection selection);

    /// Number of rays that the last add() traced. Waits for it.
    uint64_t rays() const;
    /// Returns whether this was made for frames of this size, this light and this shading variant.
    bool fits(uint32_t width, uint32_t height, RestirLight light, ShadingVariant variant) const {
        return width_ == width && height_ == height && light_ == light &&
               (receivers_.size() == 0) == has_lobes(variant);
    }

private:
    struct Frame;

    bool has_bounces() const { return light_ == RestirLight::Indirect; }
    void make_initial(LightSelection selection, Frame& frame);
    void reuse_before(const PreviousScene& before, const FrameCameras& cameras, const ChangedLight& change,
                      const Frame& frame);
    void take_rows(const Frame& frame);
    void reuse_beside(const Frame& frame);
    template <class Reservoir>
    void reuse(const SceneView& scene, const PixelSurfaces& here, const PixelSurfaces& there, const Reservoir* own,
               const Reservoir* others, Reservoir* to, uint32_t entries, SceneTracer& tracer, uint32_t group);
    template <class Reservoir>
    void test_visibility(const SceneView& scene, const PixelSurfaces& surfaces, Reservoir* reservoirs,
                         SceneTracer& tracer, uint32_t entry);

    Queue* queue_;
    uint32_t width_, height_, pixels_;
    RestirLight light_;
    RowExchange* others_ = nullptr;
    RowBand rows_; // the rows of this frame that this device makes
    bool has_history_ = false;
    CameraRays camera_before_ = {};
    SampleNumbers numbers_before_ = {};
    Buffer<EmitterPoint> hit_emitters_;
    Buffer<LightReservoir> reservoirs_; // two arrays: this frame's candidates, and the final reservoirs, with which
                                        // the next frame begins
    Buffer<BounceReservoir> bounces_;   // two arrays like `reservoirs_`, for indirect light
    Buffer<Float4> bounce_numbers_;     // arrays of FirstBounceView
    Buffer<Float4> seen_before_;        // hit and normal of the previous frame (GBufferView)
    Buffer<DiffuseReceiver> receivers_; // if all materials are diffuse
    Buffer<Neighbours> neighbours_;
    Buffer<Shares> shares_;
    Buffer<Ray> rays_;
    Buffer<Uint2> ray_ends_;
    Buffer<uint32_t> ray_words_, ray_counts_; // for each trace of a frame
    uint32_t traced_ = 0;                     // traces in this frame
};

} // namespace pertev
