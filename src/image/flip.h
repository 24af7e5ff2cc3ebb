#pragma once

// FLIP: visibility of the difference between two pictures when a viewer alternates them, from 0 (none) to 1.
//
// Source: Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", HPG 2020; HDR: Andersson et al.,
// "Visualizing Errors in Rendered High Dynamic Range Images", Eurographics 2021 Short Papers. Where paper and the
// authors' program differ, this follows the program (filter radii, edges of the picture repeated outwards).

#include <vector>

#include "base/sink.h"
#include "image/image.h"

namespace pertev {

/// The paper's viewing conditions: a display 0.7 m wide with 3840 pixels, seen from 0.7 m.
inline constexpr float kDefaultPixelsPerDegree = 67.0206432765823f;

struct FlipResult {
    double mean = 0; // mean of the map
    Image map;       // 1 channel, the error of each pixel in [0, 1]
};

/// Computes LDR-FLIP of pictures with 3 or 4 channels, linear Rec. 709 as read_image returns them for PNG and JPEG.
/// Values are clamped to [0, 1]. A pixel that is not finite in a picture has the error 1. The result is symmetric.
/// Throws Error(BadInput) if the sizes differ.
FlipResult flip(const Image& picture, const Image& reference, float pixels_per_degree = kDefaultPixelsPerDegree);

/// HDR-FLIP: the maximum LDR-FLIP of each pixel over a range of exposures that follows from the reference's
/// luminance, each through the ACES curve of the source. The number of exposures grows with the reference's contrast.
FlipResult hdr_flip(const Image& picture, const Image& reference, float pixels_per_degree = kDefaultPixelsPerDegree);

/// HDR-FLIP of each of `pictures`; the reference is processed once for all of them. Throws Error(Interrupted) if `sink`
/// stops; each exposure checks it.
std::vector<FlipResult> hdr_flips(const std::vector<const Image*>& pictures, const Image& reference,
                                  float pixels_per_degree = kDefaultPixelsPerDegree, Sink* sink = nullptr);

} // namespace pertev
