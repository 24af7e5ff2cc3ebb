#pragma once

// Pictures of a radiosity solution: it keeps the solution on the device, and trees of rays show it
// (integrators/radiosity/radiosity.h).

#include "device/buffer.h"
#include "integrators/radiosity/radiosity_look.h"
#include "integrators/ray_tree/ray_tree_integrator.h"

namespace pertev {

class RadiosityIntegrator final : public Integrator {
public:
    /// As RayTreeIntegrator.
    RadiosityIntegrator(Queue& queue, const RayTreeSettings& settings, const RadiosityLook& look, bool in_loop,
                        uint32_t batch);

    /// Bytes that begin() takes for so many samples of all pixels together. `in_loop`: threads take samples of their
    /// own.
    static std::size_t predicted_bytes(const RayTreeSettings& settings, const RadiosityLook& look, uint64_t samples,
                                       uint32_t batch, bool in_loop);

    /// Throws Error(BadInput) too, where there is no solution or it is of another scene.
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override { trees_.render(first, count, film); }
    void abandon_when(const std::atomic<bool>* flag) override { trees_.abandon_when(flag); }
    RayCounts rays() const override { return trees_.rays(); }
    std::size_t bytes() const override { return trees_.bytes() + solution_bytes_; }

    /// Count from the next begin().
    void set_settings(const RayTreeSettings& settings, const RadiosityLook& look) {
        settings_ = settings;
        look_ = look;
    }

private:
    Queue& queue_;
    RayTreeSettings settings_;
    RadiosityLook look_;
    RayTreeIntegrator<Radiosity> trees_;
    std::shared_ptr<const RadiositySolution> uploaded_; // that the buffers hold
    Buffer<PatchCode> roots_;
    Buffer<PatchQuad> quads_;
    Buffer<PatchLight> patches_;
    std::size_t solution_bytes_ = 0;
};

} // namespace pertev
