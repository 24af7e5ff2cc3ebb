#pragma once

// How many stops bring a linear picture of unknown scale to a middle grey: for scenes whose light was a default.

#include "image/image.h"

namespace pertev {

/// Stops by which the geometric mean of the luminance, over pixels between the darkest and the brightest tenth, becomes
/// 0.18 (Reinhard et al., "Photographic Tone Reproduction for Digital Images", SIGGRAPH 2002, equation 1). Within
/// [-20, 20]; 0 for a picture without light.
float auto_exposure_stops(const Image& linear);

} // namespace pertev
