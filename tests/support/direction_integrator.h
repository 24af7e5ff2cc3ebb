#pragma once

// A second integrator that uses only render/. The light of a sample is the direction of its camera ray, as a colour in
// [0, 1]. It shows that the interface does not depend on the path tracer.

#include "integrators/integrator.h"

namespace pertev::test {

class DirectionIntegrator final : public Integrator {
public:
    explicit DirectionIntegrator(Queue& queue) : queue_(queue) {}

    void reserve(const WorkSize&) override {}
    void begin(const PictureView& picture, SceneTracer& tracer, uint32_t samples) override;
    void render(uint32_t first, uint32_t count, const FilmView& film) override;
    RayCounts rays() const override { return rays_; }

private:
    Queue& queue_;
    PictureView picture_{};
    RayCounts rays_;
};

} // namespace pertev::test
