#pragma once

// Bit counting in one instruction on either device.

#include <bit>
#include <cstdint>

#include "base/host_device.h"

namespace pertev {

HD inline uint32_t count_ones(uint32_t x) {
#if PERTEV_ON_DEVICE
    return static_cast<uint32_t>(__popc(x));
#else
    return static_cast<uint32_t>(std::popcount(x));
#endif
}

/// Index of the highest bit of x, which is not 0.
HD inline uint32_t highest_bit(uint32_t x) {
#if PERTEV_ON_DEVICE
    return 31u - static_cast<uint32_t>(__clz(x));
#else
    return 31u - static_cast<uint32_t>(std::countl_zero(x));
#endif
}

HD inline uint32_t highest_bit(uint64_t x) {
#if PERTEV_ON_DEVICE
    return 63u - static_cast<uint32_t>(__clzll(static_cast<long long>(x)));
#else
    return 63u - static_cast<uint32_t>(std::countl_zero(x));
#endif
}

} // namespace pertev
