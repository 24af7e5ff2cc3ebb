#pragma once

// Rasterisation with a depth buffer and local light: the pipeline of transforms, clipping, scan conversion and shading
// without a ray. The file that orders its stages (integrators/raster/scan_triangles.h, shade_pixels.h); a sample of all
// pixels goes through them at once.

#include <cstdint>

#include "device/buffer.h"
#include "integrators/integrator.h"
#include "integrators/raster/raster_settings.h"
#include "math/float4.h"
#include "render/raster/pinhole.h"

namespace pertev {

class RasterIntegrator final : public Integrator {
public:
    /// `queue` outlives the integrator.
    RasterIntegrator(Queue& queue, const RasterSettings& settings);

    /// Bytes that begin() takes.
    static std::size_t predicted_bytes(uint64_t pixels);

    /// The camera has no lens (why_no_raster). Throws Error(OverLimit) too, for a scene with too many triangles.
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;
    void abandon_when(const std::atomic<bool>* flag) override { abandon_ = flag; }
    /// None: nothing is traced.
    RayCounts rays() const override { return {}; }
    std::size_t bytes() const override { return depths_.size() * sizeof(uint64_t) + rows_.size() * sizeof(Uint2); }

    /// Counts from the next begin().
    void set_settings(const RasterSettings& settings) { settings_ = settings; }

private:
    Queue& queue_;
    RasterSettings settings_, picture_settings_; // asked for; with the picture's own ambient light
    PictureView picture_{};
    Pinhole camera_{};
    const std::atomic<bool>* abandon_ = nullptr;
    Buffer<uint64_t> depths_, row_count_;
    Buffer<Uint2> rows_;
};

} // namespace pertev
