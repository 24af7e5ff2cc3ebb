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

    HD friend inline RgbOf operator+(RgbOf p, RgbOf q) { return {p.r + q.r, p.g + q.g, p.b + q.b}; }
    HD friend inline RgbOf operator-(RgbOf p, RgbOf q) { return {p.r - q.r, p.g - q.g, p.b - q.b}; }
    HD friend inline RgbOf operator*(RgbOf p, RgbOf q) { return {p.r * q.r, p.g * q.g, p.b * q.b}; }
    HD friend inline RgbOf operator*(T s, RgbOf p) { return {s * p.r, s * p.g, s * p.b}; }
    HD friend inline RgbOf operator/(RgbOf p, RgbOf q) { return {p.r / q.r, p.g / q.g, p.b / q.b}; }
    HD friend inline RgbOf& operator+=(RgbOf& p, RgbOf q) { return p = p + q; }

    HD friend inline RgbOf lerp(RgbOf p, RgbOf q, T t) { return p + t * (q - p); }
    HD friend inline T max_component(RgbOf p) { return max(p.r, max(p.g, p.b)); }
    HD friend inline auto is_black(RgbOf p) { return p.r == 0 && p.g == 0 && p.b == 0; }
    HD friend inline auto is_finite(RgbOf p) { return is_finite(p.r) && is_finite(p.g) && is_finite(p.b); }
    HD friend inline RgbOf select(MaskOf<T> condition, RgbOf p, RgbOf q) {
        return {select(condition, p.r, q.r), select(condition, p.g, q.g), select(condition, p.b, q.b)};
    }
    /// Relative luminance Y of linear Rec. 709 (weights of ITU-R BT.709).
    HD friend inline T luminance(RgbOf p) { return 0.2126f * p.r + 0.7152f * p.g + 0.0722f * p.b; }
};

using Rgb = RgbOf<float>;

HD inline constexpr Rgb grey(float x) { return {x, x, x}; }

} // namespace pertev
