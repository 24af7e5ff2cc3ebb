#pragma once

// Settings of integrators with ray trees, besides scene and camera.

#include <cstdint>

#include "math/rgb.h"
#include "math/sampler.h"
#include "radiosity/radiosity_view.h"
#include "shading/light_selection.h"

namespace pertev {

struct RayTreeSettings {
    uint32_t max_depth = 16; // scatterings between light and camera: 0 emission only, 1 direct light
    SamplerKind sampler = SamplerKind::Sobol;
    uint32_t seed = 0;
    LightSelection light_choice = LightSelection::Power; // for integrators that sample one of all lights
    // Radiance that reaches every diffuse surface from all directions, W/(sr m2), in place of diffuse
    // interreflection; for integrators with such a term.
    bool has_ambient = false; // `ambient` was given; otherwise the integrator's default applies
    Rgb ambient = {0, 0, 0};

    RadiosityView radiosity; // for Radiosity: the light that surfaces receive, on the device
};

/// Key of the random numbers of a sample.
HD inline SampleKey sample_key(const RayTreeSettings& settings, uint32_t pixel, uint32_t sample) {
    return {pixel, sample, settings.seed};
}

} // namespace pertev
