#pragma once

// The eight box tests of a compressed node: conservative, as in ray_boxes.h, including the error of decoding. The ray
// is a segment (ray_segment.h).
//
// A plane of the node is o' + (2^15 + q) s, with the node's origin o', a byte q and the quantum s, a power of two.
// The byte is placed in a float's mantissa, 0x4700qq00, which is exactly 2^15 + q, so that no conversion is needed
// (one byte permutation on the device). With d = direction * end, a = s / d and m = (e + 2^-7 s) |1/d|, the crossing
// is
//   fma(2^15 + q, a, fma(o' - o, 1/d, -+m))
// which moves the plane out by e and by 2^-7 of a quantum, to a smaller parameter at the entry and to a greater one
// at the exit, for either direction.
//
// Why that never misses (in terms of shifts of the plane; u, S, e and the guard of d: ray_segment.h). The product a
// is exact: s is within [2^-80, 2^34] and 1/d within [2^-42, 2^124], and their product is below 2^75. Rounding errors
// are at most: three u S for 1/d, one for the last fma; u (S + 2^15 s) each for o' - o and for the inner fma; in
// total slightly more than 6 u S, and 2^-8 s. The relative error of m is below 2^-21, even if it is denormal. The
// triangle test's own error is at most 6 u S. All of this is within 16 u S + 2^-7 s, and 3 u S remain for the needs
// of a segment.
//
// The least and the greatest of three are found from the bits as integers (ray_boxes.h), which is right for
// non-negative numbers. The node: accel/bvh/compressed_bvh.h. The arithmetic was developed for this file.

#include <cmath>
#include <cstdint>

#include "accel/bvh/compressed_bvh.h"
#include "base/host_device.h"
#include "trace/intersect/ray_boxes.h"
#include "trace/intersect/ray_segment.h"

namespace pertev {

/// The float 2^15 + byte k of the word; `base` is kByteBase.
HD inline float float_of_byte(uint32_t word, int k, uint32_t base) {
#if PERTEV_ON_DEVICE
    return float_of(__byte_perm(word, base, 0x7404u | static_cast<uint32_t>(k) << 4));
#else
    return float_of(base | (word >> (8 * k) & 0xffu) << 8);
#endif
}

/// An axis of a node for a ray: maps a byte to the parameter at which the ray crosses its plane.
struct CompressedAxis {
    float step, near, far; // near and far are offsets
    uint32_t near_planes[2], far_planes[2];
};

HD inline CompressedAxis make_compressed_axis(const CompressedBvhNode& node, int axis, float origin, float inv,
                                              float grow) {
    const bool backwards = inv < 0;
    const float s = quantum(node, axis), from = node.origin[axis] - origin;
    const float out = fma(0x1p-7f, s, grow) * abs(inv);
    CompressedAxis r;
    r.step = s * inv;
    r.near = fma(from, inv, -out);
    r.far = fma(from, inv, out);
    for (int w = 0; w < 2; ++w) {
        r.near_planes[w] = backwards ? node.planes[2 * axis + 1][w] : node.planes[2 * axis][w];
        r.far_planes[w] = backwards ? node.planes[2 * axis][w] : node.planes[2 * axis + 1][w];
    }
    return r;
}

/// Returns the mask of slots that are entered: bit s is set if the box of slot s may hold a hit with 0 < t <= r.end; it
/// is entered at entries[s] * r.end or later. Bits and entries of empty slots are undefined.
HD inline uint32_t enters_slots(Vec3 origin, const RaySegment& r, const CompressedBvhNode& node, float (&entries)[8]) {
    const CompressedAxis x = make_compressed_axis(node, 0, origin.x, r.inv.x, r.grow);
    const CompressedAxis y = make_compressed_axis(node, 1, origin.y, r.inv.y, r.grow);
    const CompressedAxis z = make_compressed_axis(node, 2, origin.z, r.inv.z, r.grow);
    uint32_t mask = 0;
#if PERTEV_ON_DEVICE
#pragma unroll
#endif
    for (int s = 7; s >= 0; --s) {
        const int w = s / 4, k = s % 4;
        const auto at = [&node](uint32_t word, int byte, float step, float add) {
            return fma_saturated(float_of_byte(word, byte, node.byte_base), step, add);
        };
        const float entry =
            greatest_bits(at(x.near_planes[w], k, x.step, x.near), at(y.near_planes[w], k, y.step, y.near),
                          at(z.near_planes[w], k, z.step, z.near));
        const float exit = min_bits(at(x.far_planes[w], k, x.step, x.far), at(y.far_planes[w], k, y.step, y.far),
                                    at(z.far_planes[w], k, z.step, z.far));
        entries[s] = entry;
        const uint32_t entered = bits_of(entry - exit); // negative; of equal ones +0
#if PERTEV_ON_DEVICE
        mask = __funnelshift_l(entered, mask, 1);
#else
        mask = mask << 1 | entered >> 31;
#endif
    }
    return mask;
}

/// The least entry of `slots` as a ray parameter: the upper half of a float's bits, rounded down; infinity for no
/// slots.
HD inline uint32_t min_entry(const float (&entries)[8], uint32_t slots, float end) {
    // Non-negative floats have the order of their bits as integers.
    const auto at = [&](int s) { return (slots & 1u << s) != 0 ? static_cast<int>(bits_of(entries[s])) : 0x7f800000; };
    const int a = min(min(at(0), at(1)), at(2)), b = min(min(at(3), at(4)), at(5));
    const int c = min(min(a, at(6)), at(7));
    return bits_of(float_of(static_cast<uint32_t>(min(b, c))) * end) >> 16;
}

/// The bit of the slot that comes first for a ray with 1 / direction `inv`, which is the least s ^ octant of the ray;
/// 0 for no slots. On each axis the nearer half is kept unless it is empty.
HD inline uint32_t nearest_slot(uint32_t slots, Vec3 inv) {
    const auto keep_nearer = [&slots](float along, uint32_t lower_half) {
        const uint32_t backwards = 0u - (bits_of(along) >> 31);
#if PERTEV_ON_DEVICE && !defined(PERTEV_EMULATED_WARPS)
        uint32_t nearer; // (a ^ b) & c in one instruction, which ptxas does not find itself
        asm("lop3.b32 %0, %1, %2, %3, 0x28;" : "=r"(nearer) : "r"(backwards), "r"(lower_half), "r"(slots));
#else
        const uint32_t nearer = slots & (backwards ^ lower_half);
#endif
        slots = nearer != 0 ? nearer : slots;
    };
    keep_nearer(inv.z, 0x0f);
    keep_nearer(inv.y, 0x33);
    keep_nearer(inv.x, 0x55);
    return slots;
}

/// The order of nearest_slot(), or its reverse, as three bytes: for the axes z, y, x from the lowest byte on, the half
/// of the slots that comes first.
HD inline uint32_t slot_order(Vec3 inv, bool far_first) {
    const auto half = [far_first](float along, uint32_t lower) {
        return (along < 0) != far_first ? lower ^ 0xffu : lower;
    };
    return half(inv.z, 0x0f) | half(inv.y, 0x33) << 8 | half(inv.x, 0x55) << 16;
}

/// The bit of the slot that comes first in a slot_order(); 0 for no slots.
HD inline uint32_t first_of_slots(uint32_t slots, uint32_t order) {
    const auto keep = [&slots](uint32_t half) { slots = (slots & half) != 0 ? slots & half : slots; };
    keep(order); // there are eight bits of slots
    keep(order >> 8);
    keep(order >> 16);
    return slots;
}

} // namespace pertev
