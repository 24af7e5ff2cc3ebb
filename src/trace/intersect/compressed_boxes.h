#pragma once

// The eight box tests of a compressed node: conservative, as ray_boxes.h is, with the decoding's own error included.
//
// A plane of the node is p + q s: p its origin, q a byte, s its quantum, a power of two. The byte is laid into a
// float's mantissa, 0x4700qq00, which is exactly 2^15 + q, so that no conversion is needed (one byte permutation on the
// device). With a = s / d and m = (e + 2^-8 s) |1/d|, the plane's parameter is
//   fma(2^15 + q, a, fma(-2^15, a, fma(p - o, 1/d, -+m)))
// which takes the 2^15 off again and moves the plane out by e and by 2^-8 of a quantum, towards less where the ray
// enters and towards more where it leaves, whichever way it goes.
//
// Why that never misses (written as a shift of the plane; u = 2^-24; S = |origin|max + |bounds|max; e = 16 u S as in
// ray_boxes.h). a is exact: s is within [2^-80, 2^34] and 1/d within [2^-40, 2^72]. Roundings, at most: of p - o, of
// 1/d, of the innermost fma and of the last one u S each (a plane passes the bounds by less than a quantum, which is
// under 4/255 S, or covered below); of the fma between them u (S + (2^15 + 1) s). Together 5 u S and a little, and
// 2^-9 s. m is right to 2^-21 of itself, even where it is denormal. The triangle test's own error is at most 6 u S.
// 16 u S + 2^-8 s hold them all. The guard: |d| < 2^-72 counts as 2^-72 here, not 2^-80, so that 2^15 a stays finite
// (2^121). A ray with |d_i| < 2^-72 moves along axis i, up to a hit, by less than 2^-72 t <= 2^-72 2^41 S = 2^-31 S,
// far less than e; so a plane that the ray truly reaches only beyond the hit is not put before it.
//
// Least and greatest of three are taken of the bits as integers (ray_boxes.h).
// The node: accel/bvh/compressed_bvh.h. The arithmetic was worked out for this file.

#include <cstdint>

#include "accel/bvh/compressed_bvh.h"
#include "base/host_device.h"
#include "trace/intersect/ray_boxes.h"
#include "trace/ray.h"

namespace pertev {

/// The ray with no component of its direction too near 0 for compressed boxes; for box tests alone.
HD inline Ray guard_for_compressed(Ray ray) {
    const auto guard = [](float d) { return abs(d) < 0x1p-72f ? copysign(0x1p-72f, d) : d; };
    ray.direction = {guard(ray.direction.x), guard(ray.direction.y), guard(ray.direction.z)};
    return ray;
}

/// 2^15 + byte k of the word; `base` is kByteBase.
HD inline float float_of_byte(uint32_t word, int k, uint32_t base) {
#if PERTEV_ON_DEVICE
    return float_of(__byte_perm(word, base, 0x7404u | static_cast<uint32_t>(k) << 4));
#else
    return float_of(base | (word >> (8 * k) & 0xffu) << 8);
#endif
}

/// What the tests of compressed boxes need of a ray besides its origin; less than RayBoxes, which would cost registers.
struct RayCompressedBoxes {
    Vec3 inv;   // 1 / direction, guarded
    float grow; // by which planes move out, metres
};

template <class Tests>
HD inline RayCompressedBoxes make_ray_compressed_boxes(const Ray& ray, float bounds_max_abs) {
    const Ray guarded = guard_for_compressed(ray);
    return {Tests::make_boxes(guarded, bounds_max_abs).inv, Tests::box_growth(ray, bounds_max_abs)};
}

/// One axis of a node, seen from a ray: what takes a byte to a parameter.
struct CompressedAxis {
    float step, near, far; // near and far: what is added
    uint32_t near_planes[2], far_planes[2];
};

HD inline CompressedAxis make_compressed_axis(const CompressedBvhNode& node, int axis, float origin, float inv,
                                              float grow) {
    const bool backwards = inv < 0;
    const float s = quantum(node, axis), from = node.origin[axis] - origin;
    const float out = fma(0x1p-8f, s, grow) * abs(inv);
    CompressedAxis r;
    r.step = s * inv;
    r.near = fma(-0x1p15f, r.step, fma(from, inv, -out));
    r.far = fma(-0x1p15f, r.step, fma(from, inv, out));
    for (int w = 0; w < 2; ++w) {
        r.near_planes[w] = backwards ? node.planes[2 * axis + 1][w] : node.planes[2 * axis][w];
        r.far_planes[w] = backwards ? node.planes[2 * axis][w] : node.planes[2 * axis + 1][w];
    }
    return r;
}

/// Bit s: the box of slot s may hold a hit with ray.t_min < t <= t_limit, and is entered at entries[s] or
/// later. Bits and entries of empty slots mean nothing.
HD inline uint32_t enters_slots(const Ray& ray, const RayCompressedBoxes& r, const CompressedBvhNode& node,
                                float t_limit, float (&entries)[8]) {
    const CompressedAxis x = make_compressed_axis(node, 0, ray.origin.x, r.inv.x, r.grow);
    const CompressedAxis y = make_compressed_axis(node, 1, ray.origin.y, r.inv.y, r.grow);
    const CompressedAxis z = make_compressed_axis(node, 2, ray.origin.z, r.inv.z, r.grow);
    uint32_t mask = 0;
#if PERTEV_ON_DEVICE
#pragma unroll
#endif
    for (int s = 7; s >= 0; --s) {
        const int w = s / 4, k = s % 4;
        const auto at = [&node](uint32_t word, int byte, float step, float add) {
            return fma(float_of_byte(word, byte, node.byte_base), step, add);
        };
        const float entry =
            greatest_bits(at(x.near_planes[w], k, x.step, x.near), at(y.near_planes[w], k, y.step, y.near),
                          at(z.near_planes[w], k, z.step, z.near));
        const float exit = least_bits(at(x.far_planes[w], k, x.step, x.far), at(y.far_planes[w], k, y.step, y.far),
                                      at(z.far_planes[w], k, z.step, z.far));
        entries[s] = entry;
        // The sign of a difference of floats is that of the comparison; equal gives +0. Entries and exits are finite.
        const uint32_t missed = bits_of(exit - entry) | bits_of(exit - ray.t_min) | bits_of(t_limit - entry);
#if PERTEV_ON_DEVICE
        mask = __funnelshift_l(missed, mask, 1);
#else
        mask = mask << 1 | missed >> 31;
#endif
    }
    return ~mask & 0xffu;
}

/// The least of the entries of `slots`, as the upper half of a float's bits, rounded down; of none, infinity.
HD inline uint32_t least_entry(const float (&entries)[8], uint32_t slots) {
    // Floats from 0 on are in the order of their bits as integers; lesser ones count as 0, since t_min >= 0.
    const auto at = [&](int s) { return (slots & 1u << s) != 0 ? static_cast<int>(bits_of(entries[s])) : 0x7f800000; };
    const int a = min(min(at(0), at(1)), at(2)), b = min(min(at(3), at(4)), at(5));
    const int c = min(min(a, at(6)), at(7));
    return static_cast<uint32_t>(max(min(b, c), 0)) >> 16;
}

/// The bit of the slot that comes first for a ray with 1 / direction `inv`: least s ^ the ray's octant; 0 of no
/// slots. At each axis the half that lies nearer is kept, unless it is empty.
HD inline uint32_t nearest_slot(uint32_t slots, Vec3 inv) {
    const auto keep_nearer = [&slots](float along, uint32_t lower_half) {
        const uint32_t backwards = 0u - (bits_of(along) >> 31);
        const uint32_t nearer = slots & (backwards ^ lower_half);
        slots = nearer != 0 ? nearer : slots;
    };
    keep_nearer(inv.z, 0x0f);
    keep_nearer(inv.y, 0x33);
    keep_nearer(inv.x, 0x55);
    return slots;
}

} // namespace pertev
