#pragma once

// A second integrator, made of what render/ gives to all of them: the light of a sample is its camera ray's direction,
// as a colour in [0, 1]. It knows nothing of the path tracer, and shows that the seam asks for nothing of it.

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
