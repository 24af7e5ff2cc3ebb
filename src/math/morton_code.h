#pragma once

// The Morton curve through a cube of cells: a code interleaves the bits of x, y and z.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

/// Spreads 21 bits to every third of 63.
HD inline uint64_t spread_bits(uint64_t x) {
    x = (x | x << 32) & 0x1f00000000ffffull;
    x = (x | x << 16) & 0x1f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

} // namespace pertev
