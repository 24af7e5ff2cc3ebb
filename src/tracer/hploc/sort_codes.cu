#include "tracer/hploc/sort_codes.h"

#include <numeric>

#include "accel/hploc/leaves.h"

#if defined(__CUDACC__)
#include <cub/device/device_radix_sort.cuh>
#endif

namespace pertev {
namespace {
constexpr int kCodeBits = 63;
} // namespace

std::size_t sort_scratch_bytes(Queue& queue, uint32_t count) {
    if (queue.is_dry_run()) { // an estimate is a copy of the input, because CUB needs a device to answer
        return queue.is_cuda() ? count * (sizeof(uint64_t) + sizeof(uint32_t)) : 0;
    }
    const Queue::Scope scope(queue, "scratch memory for sorting"); // CUB queries the thread's current device
    std::size_t bytes = 0;
#if defined(__CUDACC__)
    if (queue.is_cuda()) {
        const uint64_t* codes = nullptr;
        const uint32_t* order = nullptr;
        cub::DeviceRadixSort::SortPairs(nullptr, bytes, codes, static_cast<uint64_t*>(nullptr), order,
                                        static_cast<uint32_t*>(nullptr), count, 0, kCodeBits);
    }
#endif
    static_cast<void>(count);
    return bytes;
}

void sort_codes(Queue& queue, Buffer<std::byte>& scratch, const uint64_t* codes, const uint32_t* order,
                uint64_t* sorted_codes, uint32_t* sorted_order, uint32_t count, Sink& sink) {
    const Queue::Scope scope(queue, "sort Morton codes");
#if defined(__CUDACC__)
    if (queue.is_cuda()) {
        std::size_t bytes = scratch.size();
        cub::DeviceRadixSort::SortPairs(scratch.data(), bytes, codes, sorted_codes, order, sorted_order, count, 0,
                                        kCodeBits, static_cast<cudaStream_t>(queue.stream()));
        return queue.check_launch();
    }
#endif
    static_cast<void>(scratch), static_cast<void>(order);
    std::iota(sorted_order, sorted_order + count, 0u);
    hploc::sort_along_curve(codes, {sorted_order, count}, sink);
    for (uint32_t i = 0; i < count; ++i) sorted_codes[i] = codes[sorted_order[i]];
}

} // namespace pertev
