#pragma once

// How many blocks of a walk's kernel a GPU holds at once, and what the kernel takes of it. For .cu files.

#include <cstdint>
#include <mutex>

namespace pertev {

inline constexpr int kWalkThreads = 128; // a block
// Warps ask the counter for up to 64 indices more than there is work for, each; that must not pass 2^32.
inline constexpr uint32_t kMaxPoolCount = 1u << 31;

/// What a kernel takes, and how much of the GPU it fills.
struct KernelLimits {
    int registers = 0;   // a thread
    int local_bytes = 0; // a thread: stacks and spilled registers
    int blocks = 0;      // a multiprocessor, of kWalkThreads threads
    float occupancy = 0; // warps that fit / warps that a multiprocessor has places for
    int multiprocessors = 0;
};

#if defined(__CUDACC__)

/// Of the current device; zeros where it cannot tell (the launch will say why).
template <class Kernel>
KernelLimits limits_of(Kernel* kernel) {
    KernelLimits limits;
    int device = 0, threads = 0;
    cudaFuncAttributes attributes{};
    if (cudaGetDevice(&device) != cudaSuccess || cudaFuncGetAttributes(&attributes, kernel) != cudaSuccess ||
        cudaDeviceGetAttribute(&limits.multiprocessors, cudaDevAttrMultiProcessorCount, device) != cudaSuccess ||
        cudaDeviceGetAttribute(&threads, cudaDevAttrMaxThreadsPerMultiProcessor, device) != cudaSuccess ||
        cudaOccupancyMaxActiveBlocksPerMultiprocessor(&limits.blocks, kernel, kWalkThreads, 0) != cudaSuccess) {
        return {};
    }
    limits.registers = attributes.numRegs;
    limits.local_bytes = static_cast<int>(attributes.localSizeBytes);
    limits.occupancy = static_cast<float>(limits.blocks * kWalkThreads) / static_cast<float>(threads);
    return limits;
}

/// The limits of one kernel, asked of each device once, since asking takes longer than launching. Any thread may ask.
class LimitsByDevice {
public:
    /// Of the current device.
    template <class Kernel>
    KernelLimits of(Kernel* kernel) {
        int device = 0;
        if (cudaGetDevice(&device) != cudaSuccess) return {};
        if (device >= kDevices) return limits_of(kernel);
        std::call_once(asked_[device], [&] { limits_[device] = limits_of(kernel); });
        return limits_[device];
    }

private:
    static constexpr int kDevices = 64; // later ones are asked each time
    std::once_flag asked_[kDevices];
    KernelLimits limits_[kDevices];
};

/// Blocks that fill the GPU, or fewer where `count` threads do with them; at least 1. Where several streams go side by
/// side they fill half of it: kernels of two kinds wait for different things, and do more together than in turns.
inline uint32_t blocks_that_fit(const KernelLimits& limits, uint32_t count, int streams) {
    const int blocks = streams > 1 ? (limits.blocks + 1) / 2 : limits.blocks;
    const uint32_t fit = static_cast<uint32_t>(blocks * limits.multiprocessors);
    const uint32_t needed = (count - 1) / kWalkThreads + 1;
    return fit == 0 ? 1 : (fit < needed ? fit : needed);
}

#endif

} // namespace pertev
