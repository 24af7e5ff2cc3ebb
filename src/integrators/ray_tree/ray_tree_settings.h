#pragma once

// What integrators whose samples are trees of rays are asked for, beside scene and camera.

#include <cstdint>

#include "math/rgb.h"
#include "math/sampler.h"
#include "radiosity/radiosity_view.h"

namespace pertev {

struct RayTreeSettings {
    uint32_t max_depth = 16; // scatterings on the way from a light to the camera: 0 emission only, 1 direct light
    SamplerKind sampler = SamplerKind::Sobol;
    uint32_t seed = 0;
    // Radiance that reaches every diffuse surface from all around, W/(sr m2), in place of what diffuse surfaces send to
    // each other; of integrators that have such a term.
    bool has_ambient = false; // it was asked for; else the integrator has its own
    Rgb ambient = {0, 0, 0};

    RadiosityView radiosity; // of Radiosity: what surfaces receive; on the device
};

/// What the random numbers of a sample are drawn by.
HD inline SampleKey sample_key(const RayTreeSettings& settings, uint32_t pixel, uint32_t sample) {
    return {pixel, sample, settings.seed};
}

} // namespace pertev
