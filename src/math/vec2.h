#pragma once

// Two floats: a texture coordinate, a sample of the unit square.

#include "base/host_device.h"

namespace pertev {

struct Vec2 {
    float x = 0, y = 0;
    bool operator==(const Vec2&) const = default;
};

HD inline Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
HD inline Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
HD inline Vec2 operator*(float s, Vec2 a) { return {s * a.x, s * a.y}; }

} // namespace pertev
