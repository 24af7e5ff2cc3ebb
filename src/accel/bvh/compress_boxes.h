#pragma once

// Quantizes boxes to 8 bits per plane, rounded outwards, on host and device, for compressed nodes. All of it is
// exact, because double holds the rounding errors of float differences.

#include <cstdint>

#include "accel/bvh/compressed_bvh.h"
#include "base/host_device.h"
#include "math/bounds3.h"

namespace pertev {

/// The difference a - b without rounding error, as value + rest.
struct Difference {
    double value, rest;
};

HD inline Difference difference(float a, float b) {
    const double x = static_cast<double>(a), y = static_cast<double>(b);
    const double value = x - y, back = value - x;
    return {value, (x - (value - back)) - (y + back)};
}

inline constexpr double kCorner = 0x1p15; // quanta from a grid's origin to the plane that byte 0 stands for

// The following functions take the inverse of the quantum, which is exact because quanta are powers of two.

/// Distance of x from the corner of a grid in quanta, exact if it is in [-2^14, 2^14].
HD inline Difference quanta_from_corner(float x, float origin, double quanta_a_metre) {
    const Difference d = difference(x, origin);
    return {d.value * quanta_a_metre - kCorner, d.rest}; // exact: a product with a power of two, and a difference of
                                                         // neighbours
}

/// Largest whole number of quanta from the corner that does not exceed x, which lies above the corner.
HD inline int quanta_below(float x, float origin, double quanta_a_metre) {
    const Difference d = quanta_from_corner(x, origin, quanta_a_metre);
    const int q = static_cast<int>(d.value);
    return static_cast<double>(q) == d.value && d.rest < 0 ? q - 1 : q;
}

/// Least whole number of quanta from the corner that is not below x.
HD inline int quanta_above(float x, float origin, double quanta_a_metre) {
    const Difference d = quanta_from_corner(x, origin, quanta_a_metre);
    const int q = static_cast<int>(d.value);
    return static_cast<double>(q) < d.value || (static_cast<double>(q) == d.value && d.rest > 0) ? q + 1 : q;
}

HD inline double quanta_a_metre(uint32_t exponent) { return static_cast<double>(float_of((254 - exponent) << 23)); }

/// Next smaller float than x, which is finite.
HD inline float float_before(float x) {
    if (x == 0) return float_of(0x80000001u);
    return float_of(x > 0 ? bits_of(x) - 1 : bits_of(x) + 1);
}

/// Greatest origin whose grid corner, with this quantum, is at most lo.
HD inline float origin_below(float lo, uint32_t exponent) {
    const Difference d = difference(lo, 32768.0f * float_of(exponent << 23)); // exact: the product is a power of two
    const float origin = static_cast<float>(d.value);
    const double rounded = static_cast<double>(origin);
    return rounded > d.value || (rounded == d.value && d.rest < 0) ? float_before(origin) : origin;
}

/// Least exponent whose grid of 255 quanta from lo reaches hi.
HD inline uint32_t choose_exponent(float lo, float hi) {
    const uint32_t of_extent = bits_of(hi - lo) >> 23; // 255 quanta of 2^-8 of this suffice, or twice as large ones
    uint32_t exponent = max(of_extent, kMinQuantumExponent + 9) - 9;
    // Far from 0, where 2^15 quanta are less than half of the last digit of lo, the corner lies a whole last digit
    // below lo.
    exponent = max(exponent, max(bits_of(abs(lo)) >> 23, 40u) - 40u);
    while (true) {
        const Difference d = quanta_from_corner(hi, origin_below(lo, exponent), quanta_a_metre(exponent));
        if (d.value < 255 || (d.value == 255 && d.rest <= 0)) return exponent;
        ++exponent;
    }
}

/// Sets a node's grid for the box of all its children. Coordinates are at most kMaxCoordinate.
HD inline void lay_grid(CompressedBvhNode& node, const Bounds3& all) {
    node.exponents_and_inner &= 0xff000000u;
    for (int axis = 0; axis < 3; ++axis) {
        const uint32_t exponent = choose_exponent(component(all.lo, axis), component(all.hi, axis));
        node.origin[axis] = origin_below(component(all.lo, axis), exponent);
        node.exponents_and_inner |= exponent << (8 * axis);
    }
}

inline constexpr uint32_t kEmptyPlanes[2] = {255, 0}; // lower, upper

/// Quantizes the planes of one child along an axis, on a grid that encloses the child.
HD inline void compress_extent(const CompressedBvhNode& node, int axis, const Bounds3& box, uint32_t& lower,
                               uint32_t& upper) {
    const double scale = quanta_a_metre(node.exponents_and_inner >> (8 * axis) & 0xff);
    lower = static_cast<uint32_t>(quanta_below(component(box.lo, axis), node.origin[axis], scale));
    upper = static_cast<uint32_t>(quanta_above(component(box.hi, axis), node.origin[axis], scale));
}

/// Sets the grid and quantizes the boxes; empty ones are skipped.
HD inline void compress_boxes(CompressedBvhNode& node, const Bounds3& all, const Bounds3 (&slots)[8]) {
    lay_grid(node, all);
    for (int axis = 0; axis < 3; ++axis) {
        uint32_t words[2][2] = {};
        for (int s = 0; s < 8; ++s) {
            uint32_t lower = kEmptyPlanes[0], upper = kEmptyPlanes[1];
            if (!slots[s].is_empty()) compress_extent(node, axis, slots[s], lower, upper);
            words[0][s / 4] |= lower << (8 * (s % 4));
            words[1][s / 4] |= upper << (8 * (s % 4));
        }
        for (int k = 0; k < 2; ++k) {
            node.planes[2 * axis][k] = words[0][k];
            node.planes[2 * axis + 1][k] = words[1][k];
        }
    }
}

} // namespace pertev
