#pragma once

// Rasterization with a depth buffer and local illumination: a pipeline of transforms, clipping, scan conversion and
// shading without rays. This file orders its stages (integrators/raster/scan_triangles.h, shade_pixels.h); one sample
// of all pixels passes through them at once.

#include "device/buffer.h"
#include "integrators/integrator_base.h"
#include "integrators/raster/raster_settings.h"
#include "math/float4.h"
#include "render/raster/pinhole.h"

namespace pertev {

class RasterIntegrator final : public IntegratorBase<RasterSettings> {
public:
    RasterIntegrator(Queue& queue, const RasterSettings& settings) : IntegratorBase(queue, settings) {}

    void reserve(const WorkSize& size) override;
    /// Begins a picture whose camera has no lens (why_no_raster). Throws as Integrator::begin, and Error(OverLimit) for
    /// a scene with too many triangles.
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    /// Adds samples without tracing rays.
    void render(uint32_t first, uint32_t count, const FilmView& film) override;

private:
    Pinhole camera_{};
    Buffer<uint64_t> depths_, row_count_;
    Buffer<Uint2> rows_;
};

} // namespace pertev
