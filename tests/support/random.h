#pragma once

// Random numbers for tests. A seed and an order of calls give the same numbers everywhere, which the distributions of
// <random> do not guarantee.
//
// Source: O'Neill, "PCG", 2014, RXS-M-XS with 32 bits of state: the period is 2^32, so at most about 10^8 draws are
// useful.

#include <cmath>
#include <cstdint>

#include "math/scalar.h"
#include "math/vec2.h"
#include "math/vec3.h"

namespace pertev::test {

class Random {
public:
    explicit Random(uint32_t seed) : state_(seed) {}

    uint32_t bits() {
        state_ = state_ * 747796405u + 2891336453u;
        const uint32_t w = ((state_ >> ((state_ >> 28) + 4)) ^ state_) * 277803737u;
        return (w >> 22) ^ w;
    }
    /// Returns a number in (0, 1).
    float unit() { return (static_cast<float>(bits() >> 9) + 0.5f) * 0x1p-23f; }
    /// Returns a point of (0, 1)^2.
    Vec2 pair() {
        const float x = unit();
        return {x, unit()};
    }
    float within(float lo, float hi) { return lo + (hi - lo) * unit(); }
    uint32_t below(uint32_t n) { return static_cast<uint32_t>((static_cast<uint64_t>(bits()) * n) >> 32); }
    Vec3 point(float lo, float hi) {
        const float x = within(lo, hi), y = within(lo, hi);
        return {x, y, within(lo, hi)};
    }
    /// Returns a uniform point on the unit sphere.
    Vec3 direction() {
        const float z = within(-1, 1), phi = kTwoPi * unit(), r = std::sqrt(max(0.0f, 1 - z * z));
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

private:
    uint32_t state_;
};

} // namespace pertev::test
