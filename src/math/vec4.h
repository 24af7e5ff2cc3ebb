#pragma once

// Four floats: a tangent with its handedness in w, an RGBA colour.

#include "base/host_device.h"

namespace pertev {

struct Vec4 {
    float x = 0, y = 0, z = 0, w = 0;
    bool operator==(const Vec4&) const = default;
};

HD inline Vec4 operator+(Vec4 a, Vec4 b) { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w}; }
HD inline Vec4 operator*(float s, Vec4 a) { return {s * a.x, s * a.y, s * a.z, s * a.w}; }

} // namespace pertev
