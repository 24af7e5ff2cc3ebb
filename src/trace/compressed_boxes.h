#pragma once

// The eight box tests of a compressed node: conservative, as ray_boxes.h is, with the decoding's own error included.
//
// A plane of the node is p + q s: p its origin, q a byte, s its quantum, a power of two. The byte is laid into a
// float's mantissa, 0x4700qq00, which is exactly 2^15 + q, so that no conversion is needed (one byte permutation on the
// device). With a = s / d and base = fma(p, 1/d, lo or hi of RayBoxes) the plane's parameter is
//   fma(2^15 + q, a, fma(-(2^15 +- 2^-8), a, base))
// which takes the 2^15 off again and moves the plane out by 2^-8 of a quantum.
//
// Why that never misses (written as a shift of the plane; u = 2^-24; S = |origin|max + |bounds|max; RayBoxes moves
// planes out by e = 16 u S). a is exact: s is within [2^-80, 2^34] and 1/d within [2^-40, 2^72]. Roundings, at most: of
// 1/d, of o +- e, of its product with 1/d, of base and of the last fma u S each (a plane passes the bounds by less than
// a quantum, which is under 4/255 S, or covered below); of the inner fma u (S + (2^15 + 1) s). Together 6 u S and a
// little, and 2^-9 s. The triangle test's own error is at most 6 u S. 16 u S + 2^-8 s hold them all. The guard: |d| <
// 2^-72 counts as 2^-72 here, not 2^-80, so that 2^15 a stays finite (2^121). A ray with |d_i| < 2^-72 moves along axis
// i, up to a hit, by less than 2^-72 t <= 2^-72 2^41 S = 2^-31 S, far less than e; so a plane that the ray truly
// reaches only beyond the hit is not put before it.
//
// Least and greatest of three are taken of the bits as integers, which the device does in one instruction. For numbers
// that are not negative that is the same; among negative ones the order is reversed, so an entry may come out too small
// and an exit too large: a box is then entered in vain, never missed.
// The node: accel/bvh/compressed_bvh.h. The arithmetic was worked out for this file.

#include <cstdint>

#include "accel/bvh/compressed_bvh.h"
#include "base/host_device.h"
#include "trace/ray.h"
#include "trace/ray_boxes.h"

namespace pertev {

/// The ray with no component of its direction too near 0 for compressed boxes; for box tests alone.
HD inline Ray guard_for_compressed(Ray ray) {
    const auto guard = [](float d) { return abs(d) < 0x1p-72f ? copysign(0x1p-72f, d) : d; };
    ray.direction = {guard(ray.direction.x), guard(ray.direction.y), guard(ray.direction.z)};
    return ray;
}

/// 2^15 + byte k of the word.
HD inline float float_of_byte(uint32_t word, int k) {
#if PERTEV_ON_DEVICE
    return float_of(__byte_perm(word, 0x47000000u, 0x7404u | static_cast<uint32_t>(k) << 4));
#else
    return float_of(0x47000000u | (word >> (8 * k) & 0xffu) << 8);
#endif
}

HD inline float greatest_bits(float a, float b, float c) {
    const int x = static_cast<int>(bits_of(a)), y = static_cast<int>(bits_of(b)), z = static_cast<int>(bits_of(c));
#if PERTEV_ON_DEVICE
    return float_of(static_cast<uint32_t>(__vimax3_s32(x, y, z)));
#else
    return float_of(static_cast<uint32_t>(max(max(x, y), z)));
#endif
}
HD inline float least_bits(float a, float b, float c) {
    const int x = static_cast<int>(bits_of(a)), y = static_cast<int>(bits_of(b)), z = static_cast<int>(bits_of(c));
#if PERTEV_ON_DEVICE
    return float_of(static_cast<uint32_t>(__vimin3_s32(x, y, z)));
#else
    return float_of(static_cast<uint32_t>(min(min(x, y), z)));
#endif
}

/// One axis of a node, seen from a ray: what takes a byte to a parameter.
struct CompressedAxis {
    float step, near, far; // near and far: what is added
    uint32_t near_planes[2], far_planes[2];
};

HD inline CompressedAxis make_compressed_axis(const CompressedBvhNode& node, int axis, float inv, float lo, float hi) {
    const bool backwards = inv < 0;
    CompressedAxis r;
    r.step = quantum(node, axis) * inv;
    const float lower = fma(-(0x1p15f + 0x1p-8f), r.step, fma(node.origin[axis], inv, lo));
    const float upper = fma(-(0x1p15f - 0x1p-8f), r.step, fma(node.origin[axis], inv, hi));
    r.near = backwards ? upper : lower;
    r.far = backwards ? lower : upper;
    for (int w = 0; w < 2; ++w) {
        r.near_planes[w] = backwards ? node.planes[2 * axis + 1][w] : node.planes[2 * axis][w];
        r.far_planes[w] = backwards ? node.planes[2 * axis][w] : node.planes[2 * axis + 1][w];
    }
    return r;
}

/// Bit s: the box of slot s may hold a hit with t_min < t <= t_limit. Bits of empty slots mean nothing. `r` is of a
/// guarded ray.
HD inline uint32_t enters_slots(const RayBoxes& r, const CompressedBvhNode& node, float t_min, float t_limit) {
    const CompressedAxis x = make_compressed_axis(node, 0, r.inv.x, r.lo.x, r.hi.x);
    const CompressedAxis y = make_compressed_axis(node, 1, r.inv.y, r.lo.y, r.hi.y);
    const CompressedAxis z = make_compressed_axis(node, 2, r.inv.z, r.lo.z, r.hi.z);
    uint32_t mask = 0;
#if PERTEV_ON_DEVICE
#pragma unroll
#endif
    for (int s = 7; s >= 0; --s) {
        const int w = s / 4, k = s % 4;
        const auto at = [](uint32_t word, int byte, float step, float add) {
            return fma(float_of_byte(word, byte), step, add);
        };
        const float entry =
            box_max(greatest_bits(at(x.near_planes[w], k, x.step, x.near), at(y.near_planes[w], k, y.step, y.near),
                                  at(z.near_planes[w], k, z.step, z.near)),
                    t_min);
        const float exit =
            box_min(least_bits(at(x.far_planes[w], k, x.step, x.far), at(y.far_planes[w], k, y.step, y.far),
                               at(z.far_planes[w], k, z.step, z.far)),
                    t_limit);
        // The sign of a difference of floats is that of the comparison; equal gives +0. Entries are finite.
#if PERTEV_ON_DEVICE
        mask = __funnelshift_l(bits_of(exit - entry), mask, 1);
#else
        mask = mask << 1 | bits_of(exit - entry) >> 31;
#endif
    }
    return ~mask & 0xffu;
}

/// Bits 3 s, 3 s + 1, 3 s + 2 of the result are bit s of the mask.
HD inline uint32_t spread_slots(uint32_t mask) {
    mask = (mask | mask << 8) & 0x00f00fu;
    mask = (mask | mask << 4) & 0x0c30c3u;
    mask = (mask | mask << 2) & 0x249249u;
    return mask * 7;
}

/// Bit s of the mask goes to bit s ^ flip.
HD inline uint32_t flip_slots(uint32_t mask, uint32_t flip) {
    if (flip & 1) mask = (mask & 0x55u) << 1 | (mask >> 1 & 0x55u);
    if (flip & 2) mask = (mask & 0x33u) << 2 | (mask >> 2 & 0x33u);
    if (flip & 4) mask = (mask & 0x0fu) << 4 | (mask >> 4 & 0x0fu);
    return mask;
}

} // namespace pertev
