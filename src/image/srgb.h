#pragma once

// The sRGB transfer functions, IEC 61966-2-1, with the same results on every device.

#include "base/host_device.h"
#include "math/portable_math.h"
#include "math/rgb.h"

namespace pertev {

/// Linear value of an encoded one in [0, 1]; extended as an odd function outside.
HD inline float srgb_decode(float encoded) {
    const float e = abs(encoded);
    return copysign(e <= 0.04045f ? e / 12.92f : pow((e + 0.055f) / 1.055f, 2.4f), encoded);
}

/// Encoded value of a linear one, clamped to [0, 1]; 0 for NaN.
HD inline float srgb_encode(float linear) {
    const float x = clamp(linear, 0.0f, 1.0f);
    // At 1 the formula rounds to slightly less.
    if (x >= 1.0f) return 1.0f;
    return x <= 0.0031308f ? 12.92f * x : 1.055f * pow(x, 1.0f / 2.4f) - 0.055f;
}

HD inline Rgb srgb_decode(Rgb encoded) {
    return {srgb_decode(encoded.r), srgb_decode(encoded.g), srgb_decode(encoded.b)};
}
HD inline Rgb srgb_encode(Rgb linear) { return {srgb_encode(linear.r), srgb_encode(linear.g), srgb_encode(linear.b)}; }

/// The 8-bit value nearest to x in [0, 1], clamped; 0 for NaN.
HD inline uint8_t to_byte(float x) {
    return static_cast<uint8_t>(to_int(clamp(x, 0.0f, 1.0f) * 255.0f + 0.5f, 0, 255));
}

} // namespace pertev
