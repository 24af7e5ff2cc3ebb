#pragma once

// Automatic exposure of a linear picture of unknown scale.

#include "image/image.h"
#include "image/tone_map.h"

namespace pertev {

/// Stops by which the geometric mean of the luminance becomes 0.18 (Reinhard et al., "Photographic Tone Reproduction
/// for Digital Images", SIGGRAPH 2002, equation 1), or as many fewer as needed so that `tone_map`
///   - burns out (makes white, all channels at 255) at most 0.5 % of the counting pixels, and
///   - shows the largest channel of at most a tenth of them brighter than four fifths of white.
/// With one or three channels all pixels count. With two or four the last channel is the share of the pixel that
/// counts, by which the others are premultiplied; 0 excludes the pixel. The middle of the picture has up to eight
/// times the weight of its corners in the mean, because the subject usually is there. Means are taken over blocks of
/// pixels, some 40 along the longer side, so that noise does not matter; the mean excludes the darkest and the
/// brightest tenth. The result is a multiple of 1/100 within [-60, 60], so that a flag can state it; 0 for a picture
/// without light. Pixels that are not finite count as black.
float auto_exposure_stops(const Image& linear, ToneMap tone_map);

} // namespace pertev
