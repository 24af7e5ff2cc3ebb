#pragma once

// A ray, and its hit.

#include <cstdint>

#include "base/host_device.h"
#include "math/vec3.h"

namespace pertev {

struct Ray {
    Vec3 origin;             // metres
    float t_min = 0;         // exclusive, at least 0; t is in multiples of the direction's length
    Vec3 direction;          // any length; its largest component within [2^-40, 2^40]
    float t_max = kInfinity; // exclusive
};

/// Start and direction of a ray.
template <class T>
struct RayLineOf {
    Vec3Of<T> origin, direction; // unit
};
using RayLine = RayLineOf<float>;

inline constexpr uint32_t kNoHit = 0xffffffffu;

struct Hit {
    float t = kInfinity;
    float u = 0, v = 0;         // weights of the triangle's second and third vertex
    uint32_t instance = kNoHit; // scene order; kNoHit: no hit
    uint32_t primitive = 0;     // triangle of the instance's mesh
    bool operator==(const Hit&) const = default;
};

} // namespace pertev
