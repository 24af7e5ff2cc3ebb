#pragma once

// sRGB display value to linear light (IEC 61966-2-1), for vertex colours. Host only; no libm, so every machine gets
// the same bits: x^2.4 = x^2 (x^2)^(1/5), the fifth root by Newton's method.

namespace pertev {

/// Both in [0, 1]; more than 1 gives 1, NaN stays NaN. Within 1 ulp of the float result.
inline float decode_srgb(float encoded) {
    const double e = static_cast<double>(encoded);
    if (e >= 1) return 1;
    if (!(e > 0.04045)) return static_cast<float>(e / 12.92);
    const double x = (e + 0.055) / 1.055, square = x * x;
    double root = 1;
    for (int i = 0; i < 40; ++i) {
        const double next = (4 * root + square / (root * root * root * root)) / 5;
        if (!(next < root)) break; // from above it only falls
        root = next;
    }
    return static_cast<float>(square * root);
}

} // namespace pertev
