#pragma once

// A colour or spectral quantity in linear Rec. 709.

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

/// `T` is float, or eight floats at once on the host (math/lanes.h).
template <class T>
struct RgbOf {
    T r = 0, g = 0, b = 0;
    bool operator==(const RgbOf&) const = default;

    HD friend inline RgbOf operator+(RgbOf a, RgbOf b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
    HD friend inline RgbOf operator-(RgbOf a, RgbOf b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }
    HD friend inline RgbOf operator*(RgbOf a, RgbOf b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
    HD friend inline RgbOf operator*(T s, RgbOf a) { return {s * a.r, s * a.g, s * a.b}; }
    HD friend inline RgbOf operator/(RgbOf a, RgbOf b) { return {a.r / b.r, a.g / b.g, a.b / b.b}; }
    HD friend inline RgbOf& operator+=(RgbOf& a, RgbOf b) { return a = a + b; }

    HD friend inline RgbOf lerp(RgbOf a, RgbOf b, T t) { return a + t * (b - a); }
    HD friend inline T max_component(RgbOf a) { return max(a.r, max(a.g, a.b)); }
    HD friend inline auto is_black(RgbOf a) { return a.r == 0 && a.g == 0 && a.b == 0; }
    HD friend inline auto is_finite(RgbOf a) { return is_finite(a.r) && is_finite(a.g) && is_finite(a.b); }
    HD friend inline RgbOf select(MaskOf<T> condition, RgbOf a, RgbOf b) {
        return {select(condition, a.r, b.r), select(condition, a.g, b.g), select(condition, a.b, b.b)};
    }
    /// Relative luminance Y of linear Rec. 709 (weights of ITU-R BT.709).
    HD friend inline T luminance(RgbOf a) { return 0.2126f * a.r + 0.7152f * a.g + 0.0722f * a.b; }
};

using Rgb = RgbOf<float>;

HD inline constexpr Rgb grey(float x) { return {x, x, x}; }

} // namespace pertev
