#pragma once

// The Reyes architecture: every surface is diced to micropolygons of under a pixel, displaced, lit as a whole, and
// hidden by samples at random places. The file that orders its stages (split_stages.h, hide_micropolygon.h,
// shade_samples.h).
//
// Source: Cook, Carpenter, Catmull, "The Reyes Image Rendering Architecture", SIGGRAPH 1987.

#include <cstddef>
#include <cstdint>

#include "device/buffer.h"
#include "integrators/integrator.h"
#include "integrators/reyes/split_stages.h"

namespace pertev {

class ReyesIntegrator final : public Integrator {
public:
    /// `queue` outlives the integrator.
    ReyesIntegrator(Queue& queue, const ReyesSettings& settings);

    /// Of each pixel, that are hidden together: surfaces are diced once for all of them.
    static uint32_t samples_at_once(uint64_t pixels);
    /// Bytes that begin() takes for so many samples of each pixel.
    static std::size_t predicted_bytes(const ReyesSettings& settings, uint64_t pixels, uint32_t samples);

    /// The camera has no lens (why_no_raster). Throws Error(OverLimit) too, for a scene with too many triangles.
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    /// Throws Error(OverLimit) too, where what is displaced makes more work than is ever wanted (kMostWorkOfPixel).
    void render(uint32_t first, uint32_t count, const FilmView& film) override;
    uint32_t render_while(uint32_t first, uint32_t count, const FilmView& film,
                          const std::function<bool()>& goes_on) override;
    void abandon_when(const std::atomic<bool>* flag) override { abandon_ = flag; }
    /// None: nothing is traced.
    RayCounts rays() const override { return {}; }
    std::size_t bytes() const override;

    /// Counts from the next begin().
    void set_settings(const ReyesSettings& settings);

private:
    void upload_heights();
    bool is_abandoned() const { return abandon_ != nullptr && *abandon_; }
    template <HidingPass kPass>
    bool hide(const ReyesPass& pass, const std::function<bool()>& goes_on);
    void check_work(uint64_t pieces, uint32_t wide) const;

    Queue& queue_;
    ReyesSettings settings_;
    PictureView picture_{};
    Pinhole camera_{};
    LocalLight light_{};
    const std::atomic<bool>* abandon_ = nullptr;
    bool has_heights_ = false; // on the device, those of settings_

    Buffer<SamplePlace> places_;
    Buffer<uint64_t> nearest_, ways_;
    Buffer<uint32_t> next_, heads_, count_;
    Buffer<float> far_;
    Buffer<Piece> stack_, under_way_;
    Buffer<float> heights_;
    Buffer<DisplacementView> displacements_;
};

} // namespace pertev
