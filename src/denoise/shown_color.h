#pragma once

// The representation of a picture from frame to frame: light c as c / (1 + luminance), so that one bright colour does
// not dominate a pixel at an edge, in YCoCg, whose axes follow the differences of neighbouring colours.
//
// Source: Karis, "High Quality Temporal Supersampling", SIGGRAPH 2014.

#include "denoise/reconstruction_view.h"

namespace pertev {

/// Encodes light, W/(sr m2): Y in [0, 1), Co and Cg in (-1, 1).
HD inline Rgb shown_color(Rgb light) {
    const Rgb c = (1.0f / (1.0f + fused_luminance(light))) * light;
    return {0.25f * c.r + 0.5f * c.g + 0.25f * c.b, 0.5f * (c.r - c.b), 0.5f * c.g - 0.25f * (c.r + c.b)};
}

/// Decodes an encoded colour to light, W/(sr m2); luminances above 2^20 are indistinguishable.
HD inline Rgb light_of_shown(Rgb shown) {
    const float low = shown.r - shown.b;
    const Rgb c = {max(low + shown.g, 0.0f), max(shown.r + shown.b, 0.0f), max(low - shown.g, 0.0f)};
    return (1.0f / max(1.0f - fused_luminance(c), 0x1p-20f)) * c;
}

} // namespace pertev
