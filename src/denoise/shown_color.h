#pragma once

// The representation of a picture from frame to frame: light in YCoCg, whose axes follow the differences of
// neighbouring colours. It is linear, so that a mean over frames is one of light.
//
// Source: Karis, "High Quality Temporal Supersampling", SIGGRAPH 2014.

#include "denoise/reconstruction_view.h"

namespace pertev {

/// Most light of a channel, W/(sr m2), so that squares stay finite.
inline constexpr float kMostShown = 0x1p40f;

/// Encodes light, W/(sr m2).
HD inline Rgb shown_color(Rgb light) {
    const Rgb c = {min(light.r, kMostShown), min(light.g, kMostShown), min(light.b, kMostShown)};
    return {0.25f * c.r + 0.5f * c.g + 0.25f * c.b, 0.5f * (c.r - c.b), 0.5f * c.g - 0.25f * (c.r + c.b)};
}

/// Decodes an encoded colour to light, W/(sr m2).
HD inline Rgb light_of_shown(Rgb shown) {
    const float low = shown.r - shown.b;
    return {max(low + shown.g, 0.0f), max(shown.r + shown.b, 0.0f), max(low - shown.g, 0.0f)};
}

} // namespace pertev
