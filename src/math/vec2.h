#pragma once

// Two floats: a texture coordinate, a sample of the unit square.

#include "base/host_device.h"

namespace pertev {

/// `T` is float, or eight floats at once on the host (math/lanes.h).
template <class T>
struct Vec2Of {
    T x = 0, y = 0;
    bool operator==(const Vec2Of&) const = default;

    HD friend inline Vec2Of operator+(Vec2Of a, Vec2Of b) { return {a.x + b.x, a.y + b.y}; }
    HD friend inline Vec2Of operator-(Vec2Of a, Vec2Of b) { return {a.x - b.x, a.y - b.y}; }
    HD friend inline Vec2Of operator*(T s, Vec2Of a) { return {s * a.x, s * a.y}; }
};

using Vec2 = Vec2Of<float>;

} // namespace pertev
