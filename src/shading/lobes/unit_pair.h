#pragma once

// Two numbers in [0, 1] of 16 bits each, for lobes with many parameters. 0 and 1 are exact.

#include <cstdint>

#include "base/host_device.h"
#include "math/scalar.h"

namespace pertev {

struct UnitPair {
    uint32_t bits;

    HD explicit UnitPair(uint32_t both) : bits(both) {}
    HD UnitPair(float low, float high) : bits(word_of(low) | word_of(high) << 16) {}
    HD float low() const { return number_of(bits & 0xffffu); }
    HD float high() const { return number_of(bits >> 16); }
    HD static uint32_t word_of(float x) { return static_cast<uint32_t>(to_int(65535.0f * x + 0.5f, 0, 65535)); }

private:
    HD static float number_of(uint32_t word) { return static_cast<float>(word) * (1.0f / 65535.0f); }
};

} // namespace pertev
