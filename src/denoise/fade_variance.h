#pragma once

// The variance by which the filters of a single picture compare light. With few samples it is that of the light. With
// many, their deviations would still span edges of light that the samples show well, so it falls faster: once the
// light's deviation is a small part of the light, the filter's tolerance falls as that part does.

#include "math/float4.h"
#include "math/rgb.h"

#include <cstdlib>

namespace pertev {

/// Returns the variance for the filter of light that is known to `variance`.
HD inline float faded_variance(Rgb light, float variance) {
    static const float kFull = std::getenv("FADE") ? static_cast<float>(atof(std::getenv("FADE"))) : 0.1f;
    const float least = square(kFull * fused_luminance(light));
    return variance < least ? variance * (variance / least) : variance;
}

} // namespace pertev
