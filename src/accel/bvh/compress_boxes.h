#pragma once

// Boxes in 8 bits a plane, rounded outwards, on either device: what compressed nodes are filled with. All of it is
// exact: double holds what floats' differences leave.

#include <cstdint>

#include "accel/bvh/compressed_bvh.h"
#include "base/host_device.h"
#include "math/bounds3.h"

namespace pertev {

/// a - b without error: value + rest.
struct Difference {
    double value, rest;
};

HD inline Difference difference(float a, float b) {
    const double x = static_cast<double>(a), y = static_cast<double>(b);
    const double value = x - y, back = value - x;
    return {value, (x - (value - back)) - (y + back)};
}

// Of the quantum's inverse, which is exact: quanta are powers of two.

/// Largest whole number of quanta from `origin` that does not pass x; x >= origin.
HD inline int quanta_below(float x, float origin, double quanta_a_metre) {
    const Difference d = difference(x, origin);
    const double quotient = d.value * quanta_a_metre;
    const int q = static_cast<int>(quotient);
    return static_cast<double>(q) == quotient && d.rest < 0 ? q - 1 : q;
}

/// Least whole number that is not short of it.
HD inline int quanta_above(float x, float origin, double quanta_a_metre) {
    const Difference d = difference(x, origin);
    const double quotient = d.value * quanta_a_metre;
    const int q = static_cast<int>(quotient);
    return static_cast<double>(q) < quotient || (static_cast<double>(q) == quotient && d.rest > 0) ? q + 1 : q;
}

HD inline double quanta_a_metre(uint32_t exponent) { return static_cast<double>(float_of((254 - exponent) << 23)); }

/// The least exponent whose grid of 255 quanta reaches from lo to hi.
HD inline uint32_t choose_exponent(float lo, float hi) {
    const uint32_t of_extent = bits_of(hi - lo) >> 23; // 255 quanta of 2^-8 of this reach, or those of twice that do
    uint32_t exponent = max(of_extent, kMinQuantumExponent + 9) - 9;
    while (quanta_above(hi, lo, quanta_a_metre(exponent)) > 255) ++exponent;
    return exponent;
}

/// Lays a node's grid over the box of all its children. Coordinates are at most kMaxCoordinate.
HD inline void lay_grid(CompressedBvhNode& node, const Bounds3& all) {
    node.exponents_and_inner &= 0xff000000u;
    for (int axis = 0; axis < 3; ++axis) {
        node.origin[axis] = component(all.lo, axis) + 0.0f; // -0 is 0, whichever a minimum found
        node.exponents_and_inner |= choose_exponent(component(all.lo, axis), component(all.hi, axis)) << (8 * axis);
    }
}

inline constexpr uint32_t kEmptyPlanes[2] = {255, 0}; // lower, upper

/// The bytes of planes[2 axis] and planes[2 axis + 1] of one child, on a grid that reaches around it.
HD inline void compress_extent(const CompressedBvhNode& node, int axis, const Bounds3& box, uint32_t& lower,
                               uint32_t& upper) {
    const double scale = quanta_a_metre(node.exponents_and_inner >> (8 * axis) & 0xff);
    lower = static_cast<uint32_t>(quanta_below(component(box.lo, axis), node.origin[axis], scale));
    upper = static_cast<uint32_t>(quanta_above(component(box.hi, axis), node.origin[axis], scale));
}

/// Lays the grid and rounds boxes outwards; empty ones are left out.
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
