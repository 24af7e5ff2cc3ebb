#pragma once

// Atomic operations on both devices, in relaxed order. Additions are for integers only, whose sum does not depend on
// the order.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

/// Adds `value` to `*target` and returns the old value.
HD inline uint32_t atomic_add(uint32_t* target, uint32_t value) {
#if PERTEV_ON_DEVICE
    return atomicAdd(target, value);
#else
    return __atomic_fetch_add(target, value, __ATOMIC_RELAXED);
#endif
}

HD inline uint64_t atomic_add(uint64_t* target, uint64_t value) {
#if PERTEV_ON_DEVICE
    return atomicAdd(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
#else
    return __atomic_fetch_add(target, value, __ATOMIC_RELAXED);
#endif
}

/// Stores `value` in `*target` and returns the old value.
HD inline uint32_t atomic_exchange(uint32_t* target, uint32_t value) {
#if PERTEV_ON_DEVICE
    return atomicExch(target, value);
#else
    return __atomic_exchange_n(target, value, __ATOMIC_RELAXED);
#endif
}

} // namespace pertev
