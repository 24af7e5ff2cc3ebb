#pragma once

// Places in lists to which every thread of a launch may have something to add. A block takes those of all its threads
// by one atomic addition a list: where each warp did so by itself, additions to one address were what shading of simple
// scenes took its time for.

#include <cstdint>

#include "base/host_device.h"
#include "device/atomic_add.h"

namespace pertev {

/// In the order of their lists; of a list that a thread adds nothing to, without meaning.
template <int kLists>
struct ListPlaces {
    uint32_t at[kLists];
};

/// What threads of a block share of kLists lists, for a stage that runs with whole blocks (device/launch.h): made
/// first, and asked once.
template <int kLists>
class BlockLists {
public:
    HD BlockLists() {
#if PERTEV_ON_DEVICE
        if (threadIdx.x < kLists) shared()[threadIdx.x] = 0;
        __syncthreads();
#endif
    }

    /// Places for this thread's elements of the lists that it `adds` to; *sizes[l], in the queue's memory, grows by
    /// theirs. On the device all threads of the block come here.
    HD ListPlaces<kLists> take(uint32_t* const (&sizes)[kLists], const bool (&adds)[kLists]) const {
        ListPlaces<kLists> places = {};
#if PERTEV_ON_DEVICE
        uint32_t* const counts = shared();
        for (int l = 0; l < kLists; ++l) {
            if (adds[l]) places.at[l] = atomicAdd(counts + l, 1u);
        }
        __syncthreads();
        if (threadIdx.x < kLists) { // side by side, which a loop would not be
            uint32_t* size = sizes[0];
            for (int l = 1; l < kLists; ++l) {
                if (threadIdx.x == static_cast<uint32_t>(l)) size = sizes[l];
            }
            const uint32_t count = counts[threadIdx.x];
            counts[kLists + threadIdx.x] = count > 0 ? atomicAdd(size, count) : 0u;
        }
        __syncthreads();
        for (int l = 0; l < kLists; ++l) places.at[l] += counts[kLists + l];
#else
        for (int l = 0; l < kLists; ++l) {
            if (adds[l]) places.at[l] = atomic_add(sizes[l], 1u);
        }
#endif
        return places;
    }

private:
#if PERTEV_ON_DEVICE
    __device__ static uint32_t* shared() { // how many the block adds, then where they begin
        __shared__ uint32_t numbers[2 * kLists];
        return numbers;
    }
#endif
};

} // namespace pertev
