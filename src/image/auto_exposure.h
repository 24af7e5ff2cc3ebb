#pragma once

// How many stops bring a linear picture of unknown scale to a middle grey: for scenes whose light was a default.

#include "image/image.h"

namespace pertev {

/// Stops by which the geometric mean of the luminance becomes 0.18 (Reinhard et al., "Photographic Tone Reproduction
/// for Digital Images", SIGGRAPH 2002, equation 1), or fewer, so that at most a tenth of the picture passes 1. Taken
/// over blocks of pixels, some 40 along the longer side, so that noise does not matter; the mean leaves out the darkest
/// and the brightest tenth. Within [-20, 20]; 0 for a picture without light.
float auto_exposure_stops(const Image& linear);

} // namespace pertev
