#pragma once

// The albedo of one scattering, from the colour that a body of the medium shows after many.
//
// Source: Kulla, Conty, "Revisiting Physically Based Shading at Imageworks", SIGGRAPH course 2017; it is the mapping of
// KHR_materials_volume_scatter.

#include "math/scalar.h"

namespace pertev {

/// Returns the share of the extinction that is scattering, [0, 1]; `shown` is the albedo of many scatterings, [0, 1].
inline float single_scatter_albedo(float shown) {
    const float c = clamp(shown, 0.0f, 1.0f);
    const float s = 4.09712f + 4.20863f * c - sqrt(9.59217f + 41.6808f * c + 17.7126f * c * c);
    return clamp(1.0f - s * s, 0.0f, 1.0f);
}

} // namespace pertev
