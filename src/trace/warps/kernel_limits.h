#pragma once

// The number of blocks of a traversal kernel that a GPU holds at once, and the kernel's resource use. For .cu files.

#include <cstdint>
#include <mutex>

namespace pertev {

inline constexpr int kTraversalThreads = 128; // per block
// Each warp may request up to 64 indices more than there are; the sum must not exceed 2^32.
inline constexpr uint32_t kMaxPoolCount = 1u << 31;

/// Resource use and occupancy of a kernel.
struct KernelLimits {
    int registers = 0;   // per thread
    int local_bytes = 0; // per thread: stacks and spilled registers
    int blocks = 0;      // per multiprocessor, with kTraversalThreads threads each
    float occupancy = 0; // resident warps / maximum warps of a multiprocessor
    int multiprocessors = 0;
};

#if defined(__CUDACC__)

/// Limits on the current device; zeros if it cannot report them (the launch will report why).
template <class Kernel>
KernelLimits limits_of(Kernel* kernel) {
    KernelLimits limits;
    int device = 0, threads = 0;
    cudaFuncAttributes attributes{};
    if (cudaGetDevice(&device) != cudaSuccess || cudaFuncGetAttributes(&attributes, kernel) != cudaSuccess ||
        cudaDeviceGetAttribute(&limits.multiprocessors, cudaDevAttrMultiProcessorCount, device) != cudaSuccess ||
        cudaDeviceGetAttribute(&threads, cudaDevAttrMaxThreadsPerMultiProcessor, device) != cudaSuccess ||
        cudaOccupancyMaxActiveBlocksPerMultiprocessor(&limits.blocks, kernel, kTraversalThreads, 0) != cudaSuccess) {
        return {};
    }
    limits.registers = attributes.numRegs;
    limits.local_bytes = static_cast<int>(attributes.localSizeBytes);
    limits.occupancy = static_cast<float>(limits.blocks * kTraversalThreads) / static_cast<float>(threads);
    return limits;
}

/// Limits of one kernel, queried once per device, because a query takes longer than a launch. Thread-safe.
class LimitsByDevice {
public:
    /// Limits on the current device.
    template <class Kernel>
    KernelLimits of(Kernel* kernel) {
        int device = 0;
        if (cudaGetDevice(&device) != cudaSuccess) return {};
        if (device >= kDevices) return limits_of(kernel);
        std::call_once(requested_[device], [&] { limits_[device] = limits_of(kernel); });
        return limits_[device];
    }

private:
    static constexpr int kDevices = 64; // further devices are queried each time
    std::once_flag requested_[kDevices];
    KernelLimits limits_[kDevices];
};

/// Number of blocks that fill the GPU, or fewer if `count` threads need fewer; at least 1. With concurrent streams
/// they fill half of it, because kernels of two kinds wait for different resources and do more together than in
/// turns.
inline uint32_t blocks_that_fit(const KernelLimits& limits, uint32_t count, int streams) {
    const int blocks = streams > 1 ? (limits.blocks + 1) / 2 : limits.blocks;
    const uint32_t fit = static_cast<uint32_t>(blocks * limits.multiprocessors);
    const uint32_t needed = (count - 1) / kTraversalThreads + 1;
    return fit == 0 ? 1 : (fit < needed ? fit : needed);
}

#endif

} // namespace pertev
