#pragma once

// The Reyes architecture: every surface is diced into micropolygons smaller than a pixel, displaced, shaded as a
// whole, and hidden by stochastic samples. This file orders its stages (split_stages.h, hide_micropolygon.h,
// shade_samples.h).
//
// Source: Cook, Carpenter, Catmull, "The Reyes Image Rendering Architecture", SIGGRAPH 1987.

#include <cstdint>

#include "device/buffer.h"
#include "integrators/integrator_base.h"
#include "integrators/reyes/split_stages.h"

namespace pertev {

class ReyesIntegrator final : public IntegratorBase<ReyesSettings> {
public:
    ReyesIntegrator(Queue& queue, const ReyesSettings& settings) : IntegratorBase(queue, settings) {}

    /// Samples per pixel that are hidden together, so that surfaces are diced once for all of them.
    static uint32_t samples_at_once(uint64_t pixels);
    void reserve(const WorkSize& size) override;
    /// Begins a picture whose camera has no lens (why_no_raster). Throws as Integrator::begin, and Error(OverLimit) for
    /// a scene with too many triangles.
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    /// Adds samples without tracing rays. Throws as Integrator::render, and Error(OverLimit) if displaced surfaces make
    /// too much work (kMaxWorkOfPixel).
    void render(uint32_t first, uint32_t count, const FilmView& film) override;
    uint32_t render_while(uint32_t first, uint32_t count, const FilmView& film,
                          const std::function<bool()>& goes_on) override;

private:
    void upload_heights();
    template <HidingPass kPass>
    bool hide(const ReyesPass& pass, const std::function<bool()>& goes_on);
    void check_work(uint64_t pieces, uint32_t wide) const;

    Pinhole camera_{};
    LocalLight light_{};
    std::shared_ptr<const HeightMaps> uploaded_; // the maps on the device

    Buffer<SamplePosition> positions_;
    Buffer<uint64_t> nearest_, split_paths_;
    Buffer<uint32_t> next_, heads_, count_;
    Buffer<float> far_;
    Buffer<Piece> stack_, pieces_;
    Buffer<float> heights_;
    Buffer<DisplacementView> displacements_;
};

} // namespace pertev
