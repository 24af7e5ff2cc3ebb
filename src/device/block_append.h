#pragma once

// Appends to lists from every thread of a launch. A block reserves the slots of all its threads by one atomic
// addition per list. With one addition per warp, the contention on one address dominated the shading of simple
// scenes.

#include <cstdint>

#include "base/host_device.h"
#include "device/atomics.h"
#include "device/sync_block.h"

namespace pertev {

/// Slots by list; undefined for a list to which the thread appends nothing.
template <int kLists>
struct ListSlots {
    uint32_t at[kLists];
};

/// Shared memory of a block for kLists lists, for a stage that runs in whole blocks (device/launch.h). take() may be
/// called once.
template <int kLists>
class BlockAppend {
public:
    HD BlockAppend() {
#if PERTEV_ON_DEVICE
        if (threadIdx.x < kLists) shared()[threadIdx.x] = 0;
        sync_block();
#endif
    }

    /// Reserves slots for this thread's elements of the lists that it `adds` to, and increases *sizes[l], in the
    /// queue's memory. On the device all threads of the block must call it.
    HD ListSlots<kLists> take(uint32_t* const (&sizes)[kLists], const bool (&adds)[kLists]) const {
        ListSlots<kLists> slots = {};
#if PERTEV_ON_DEVICE
        uint32_t* const counts = shared();
        for (int l = 0; l < kLists; ++l) {
            if (adds[l]) slots.at[l] = atomicAdd(counts + l, 1u);
        }
        sync_block();
        if (threadIdx.x < kLists) { // in parallel, which a loop would not be
            uint32_t* size = sizes[0];
            for (int l = 1; l < kLists; ++l) {
                if (threadIdx.x == static_cast<uint32_t>(l)) size = sizes[l];
            }
            const uint32_t count = counts[threadIdx.x];
            counts[kLists + threadIdx.x] = count > 0 ? atomicAdd(size, count) : 0u;
        }
        sync_block();
        for (int l = 0; l < kLists; ++l) slots.at[l] += counts[kLists + l];
#else
        for (int l = 0; l < kLists; ++l) {
            if (adds[l]) slots.at[l] = atomic_add(sizes[l], 1u);
        }
#endif
        return slots;
    }

private:
#if PERTEV_ON_DEVICE
    __device__ static uint32_t* shared() { // counts of the block, then the first slots
        __shared__ uint32_t numbers[2 * kLists];
        return numbers;
    }
#endif
};

} // namespace pertev
