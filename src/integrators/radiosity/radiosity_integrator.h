#pragma once

// Pictures of a radiosity solution: it keeps the solution on the device, and trees of rays show it
// (integrators/radiosity/radiosity.h).

#include "integrators/radiosity/radiosity_look.h"
#include "integrators/ray_tree/ray_tree_integrator.h"

namespace pertev {

class RadiosityIntegrator final : public RayTreeIntegrator<Radiosity> {
public:
    struct Settings {
        RayTreeSettings trees;
        RadiosityLook look;
    };
    /// As RayTreeIntegrator.
    RadiosityIntegrator(Queue& queue, const Settings& settings, bool in_loop, uint32_t batch)
        : RayTreeIntegrator(queue, settings.trees, in_loop, batch), look_(settings.look) {}

    void reserve(const WorkSize& size) override;
    /// Throws Error(BadInput) too, where there is no solution or it is of another scene.
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;

    /// Count from the next begin().
    void set_settings(const Settings& settings) {
        RayTreeIntegrator::set_settings(settings.trees);
        look_ = settings.look;
    }

private:
    RadiosityLook look_;
    std::shared_ptr<const RadiositySolution> uploaded_; // that the buffers hold
    Buffer<PatchCode> roots_;
    Buffer<PatchQuad> quads_;
    Buffer<PatchLight> patches_;
};

} // namespace pertev
