#pragma once

// The equal-area map between the unit sphere and the unit square by an octahedron: equal parts of the square are equal
// solid angles. The middle of the square is +z, its corners are -z, and +x and +y lie towards the last column and row.
//
// Source: Clarberg, "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD", JGT 13(3), 2008.

#include "base/host_device.h"
#include "math/portable_math.h"
#include "math/scalar.h"
#include "math/vec2.h"
#include "math/vec3.h"

namespace pertev {

/// Returns where the square has the unit direction d, in [0, 1] from its first row and column.
HD inline Vec2 octahedral_uv(Vec3 d) {
    const float x = abs(d.x), y = abs(d.y), root = sqrt(max(1 - abs(d.z), 0.0f));
    const float share = x == 0 && y == 0 ? 0.0f : atan2(y, x) * (2 / kPi);
    const float across = share * root, along = root - across;
    const bool is_below = d.z < 0;
    const float u = is_below ? 1 - across : along, v = is_below ? 1 - along : across;
    return {0.5f + (d.x < 0 ? -0.5f : 0.5f) * u, 0.5f + (d.y < 0 ? -0.5f : 0.5f) * v};
}

/// Returns the unit direction at a point of the square.
HD inline Vec3 octahedral_direction(Vec2 uv) {
    const float u = 2.0f * uv.x - 1.0f, v = 2.0f * uv.y - 1.0f;
    const float inside = 1.0f - (abs(u) + abs(v)); // negative below the equator
    const float root = max(1.0f - abs(inside), 0.0f);
    const float along = inside < 0 ? 1.0f - abs(v) : abs(u), across = inside < 0 ? 1.0f - abs(u) : abs(v);
    const float quarter = root > 0 ? 0.25f * across / (along + across) : 0.0f; // turns from x towards y
    float sine, cosine;
    sin_cos_2pi(quarter, sine, cosine);
    const float radius = root * safe_sqrt(2.0f - root * root), height = 1.0f - root * root;
    return {copysign(radius * cosine, u), copysign(radius * sine, v), copysign(height, inside)};
}

} // namespace pertev
