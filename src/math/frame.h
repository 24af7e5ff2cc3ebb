#pragma once

// Right-handed orthonormal frame about a unit normal; +z is the normal in local coordinates.
//
// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017 (branchless, no singular direction).

#include "base/host_device.h"
#include "math/vec3.h"

namespace pertev {

template <class T>
struct FrameOf {
    Vec3Of<T> tangent, bitangent, normal;

    HD Vec3Of<T> to_local(Vec3Of<T> v) const { return {dot(v, tangent), dot(v, bitangent), dot(v, normal)}; }
    HD Vec3Of<T> to_world(Vec3Of<T> v) const { return v.x * tangent + v.y * bitangent + v.z * normal; }

    HD friend inline FrameOf select(MaskOf<T> condition, FrameOf a, FrameOf b) {
        return {select(condition, a.tangent, b.tangent), select(condition, a.bitangent, b.bitangent),
                select(condition, a.normal, b.normal)};
    }
};

using Frame = FrameOf<float>;

/// Frame around the unit vector n; the tangent is some direction across it, continuous in n except at n.z = 0.
template <class T = float>
HD inline FrameOf<T> make_frame(Vec3Of<T> n) {
    const T sign = copysign(T(1.0f), n.z);
    const T a = -1.0f / (sign + n.z);
    const T b = n.x * n.y * a;
    return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

} // namespace pertev
