#pragma once

// How many stops make a linear picture of unknown scale one that is pleasant to look at.

#include "image/image.h"
#include "image/tone_map.h"

namespace pertev {

/// Stops by which the geometric mean of the luminance becomes 0.18 (Reinhard et al., "Photographic Tone Reproduction
/// for Digital Images", SIGGRAPH 2002, equation 1), or as many fewer as it takes so that `tone_map`
///   - burns (makes white, all channels at 255) at most 0.5 % of what counts, and
///   - shows the largest channel of at most a tenth of what counts brighter than four fifths of white.
/// One or three channels count everywhere. Of two or four the last says where: the share of the pixel that counts, with
/// which the others are multiplied already; 0 leaves the pixel out. The middle of the picture weighs up to eight times
/// as much in the mean as its corners, since what a picture shows is there. Means are taken over blocks of pixels, some
/// 40 along the longer side, so that noise does not matter; the mean leaves out the darkest and the brightest tenth. A
/// multiple of 1/100 within [-60, 60], so that a flag can say it; 0 for a picture without light. Pixels that are not
/// finite count as black.
float auto_exposure_stops(const Image& linear, ToneMap tone_map);

} // namespace pertev
