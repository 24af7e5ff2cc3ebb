#pragma once

// Checks of the functions that take sixteen numbers at once, in a file that is compiled for processors with AVX-512.

#include <cstdint>

namespace pertev::test {

/// Lanes that differ from the scalar functions.
struct LaneDifferences {
    uint32_t count = 0;
    int line = 0; // in check_lanes.inl, of the last one
};

#if defined(PERTEV_HAS_16_LANES)
/// Compares lanes by AVX-512; the processor must have_sixteen_lanes.
LaneDifferences check_lanes_of_16();
#endif

} // namespace pertev::test
