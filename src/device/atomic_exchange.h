#pragma once

// Atomic exchange on both devices, in relaxed order.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

/// Stores `value` in `*target` and returns the old value.
HD inline uint32_t atomic_exchange(uint32_t* target, uint32_t value) {
#if PERTEV_ON_DEVICE
    return atomicExch(target, value);
#else
    return __atomic_exchange_n(target, value, __ATOMIC_RELAXED);
#endif
}

} // namespace pertev
