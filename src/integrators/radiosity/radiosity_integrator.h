#pragma once

// Pictures of a radiosity solution: copies the solution to the device and renders it with ray trees
// (integrators/radiosity/radiosity.h).

#include "integrators/radiosity/radiosity_display_settings.h"
#include "integrators/ray_tree/ray_tree_integrator.h"

namespace pertev {

class RadiosityIntegrator final : public RayTreeIntegrator<Radiosity> {
public:
    struct Settings {
        RayTreeSettings trees;
        RadiosityDisplay display;
    };
    /// Makes an integrator; `queue`, `in_loop` and `batch` are those of RayTreeIntegrator.
    RadiosityIntegrator(Queue& queue, const Settings& settings, bool in_loop, uint32_t batch)
        : RayTreeIntegrator(queue, settings.trees, in_loop, batch), display_(settings.display) {}

    void reserve(const WorkSize& size) override;
    /// Begins a picture. Throws as Integrator::begin, and Error(BadInput) if there is no solution or it belongs to
    /// another scene.
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;

    /// Changes the settings at the next begin().
    void set_settings(const Settings& settings) {
        RayTreeIntegrator::set_settings(settings.trees);
        display_ = settings.display;
    }

private:
    RadiosityDisplay display_;
    std::shared_ptr<const RadiositySolution> uploaded_; // the solution in the buffers
    Buffer<PatchCode> roots_;
    Buffer<PatchQuad> quads_;
    Buffer<PatchLight> patches_;
};

} // namespace pertev
