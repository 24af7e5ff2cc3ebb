#pragma once

// Atomic minimum on both devices, in relaxed order, on which the result does not depend.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

HD inline void atomic_min(uint64_t* target, uint64_t value) {
#if PERTEV_ON_DEVICE
    atomicMin(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
#else
    uint64_t seen = __atomic_load_n(target, __ATOMIC_RELAXED);
    while (value < seen &&
           !__atomic_compare_exchange_n(target, &seen, value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
    }
#endif
}

} // namespace pertev
