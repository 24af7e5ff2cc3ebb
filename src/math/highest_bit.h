#pragma once

// Position of the highest bit of a word that is set.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

/// 0 to 63; `bits` is not 0.
HD inline int highest_bit(uint64_t bits) {
#if PERTEV_ON_DEVICE
    return 63 - __clzll(static_cast<long long>(bits));
#else
    return 63 - __builtin_clzll(bits);
#endif
}

} // namespace pertev
