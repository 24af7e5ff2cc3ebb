#pragma once

// A colour or spectral quantity in linear Rec. 709.

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

struct Rgb {
    float r = 0, g = 0, b = 0;
    bool operator==(const Rgb&) const = default;
};

HD inline constexpr Rgb grey(float x) { return {x, x, x}; }
HD inline Rgb operator+(Rgb a, Rgb b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
HD inline Rgb operator-(Rgb a, Rgb b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }
HD inline Rgb operator*(Rgb a, Rgb b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
HD inline Rgb operator*(float s, Rgb a) { return {s * a.r, s * a.g, s * a.b}; }
HD inline Rgb operator/(Rgb a, Rgb b) { return {a.r / b.r, a.g / b.g, a.b / b.b}; }
HD inline Rgb& operator+=(Rgb& a, Rgb b) { return a = a + b; }

HD inline Rgb lerp(Rgb a, Rgb b, float t) { return a + t * (b - a); }
HD inline float max_component(Rgb a) { return max(a.r, max(a.g, a.b)); }
HD inline bool is_black(Rgb a) { return a.r == 0 && a.g == 0 && a.b == 0; }
HD inline bool is_finite(Rgb a) { return is_finite(a.r) && is_finite(a.g) && is_finite(a.b); }
/// Relative luminance Y of linear Rec. 709 (weights of ITU-R BT.709).
HD inline float luminance(Rgb a) { return 0.2126f * a.r + 0.7152f * a.g + 0.0722f * a.b; }

} // namespace pertev
