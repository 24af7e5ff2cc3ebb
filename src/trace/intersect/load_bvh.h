#pragma once

// Loads of nodes and triangles: 16 bytes at a time through the read-only path on the device, a plain copy on the
// host.

#include "accel/bvh/bvh.h"
#include "accel/bvh/tlas.h"
#include "base/host_device.h"

namespace pertev {

/// Returns a copy of *p; sizeof(T) is a multiple of 16.
template <class T>
HD inline T load_aligned(const T* p) {
    static_assert(sizeof(T) % 16 == 0 && alignof(T) >= 16);
#if PERTEV_ON_DEVICE
    T value;
    const uint4* from = reinterpret_cast<const uint4*>(p);
    uint4* to = reinterpret_cast<uint4*>(&value);
#pragma unroll
    for (unsigned i = 0; i < sizeof(T) / 16; ++i) to[i] = __ldg(from + i);
    return value;
#else
    return *p;
#endif
}

} // namespace pertev
