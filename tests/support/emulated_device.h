#pragma once

// Emulates compilation for a device: CUDA's names, over the warps of emulated_warp.h. A file that includes this before
// any header of src/ gets the device code of all later includes, including kernels, and can run it on the host.
//
// One definition rule: such code must never be linked with host code of the same name. So from here on `pertev` is
// pertev_emulated, which nothing else uses, and everything that such a file compiles is in that namespace. Views of
// the host are passed by address (emulated_traversals.cpp). The object has no weak symbol of the host's namespace:
//   nm -C OBJECT | grep ' [VWu] ' | grep pertev::    lists only templates of std
// It is compiled with frame pointers (tests/CMakeLists.txt), because __activemask() distinguishes places by their
// call stacks.

#if defined(HD)
#error "tests/support/emulated_device.h comes before every header of src/"
#endif

#include <cstdint>
#include <source_location>
#include <utility>

#include "tests/support/emulated_warp.h"

namespace pertev_emulated::lane {
using namespace pertev::test::lane; // NOLINT: before the name changes its meaning
}

#define PERTEV_EMULATED_WARPS
#define pertev pertev_emulated
#define __device__
#define __global__
#define __launch_bounds__(...)
#define __grid_constant__

namespace pertev {

using CodeLocation = std::source_location;

inline const lane::Index &threadIdx = lane::thread_index, &blockIdx = lane::block_index, &blockDim = lane::block_size;

inline uint32_t __activemask(CodeLocation at = CodeLocation::current()) { return lane::active_mask(at); }
inline uint32_t __ballot_sync(uint32_t mask, bool mine, CodeLocation at = CodeLocation::current()) {
    return lane::ballot(mask, mine, at);
}
inline int __all_sync(uint32_t mask, bool mine, CodeLocation at = CodeLocation::current()) {
    return lane::all(mask, mine, at);
}
inline uint32_t __match_any_sync(uint32_t mask, unsigned long long key, CodeLocation at = CodeLocation::current()) {
    return lane::match_any(mask, key, at);
}
inline uint32_t __shfl_sync(uint32_t mask, uint32_t value, int source, CodeLocation at = CodeLocation::current()) {
    return lane::shuffle(mask, value, source, at);
}
inline void __syncwarp(uint32_t mask = 0xffffffffu, CodeLocation at = CodeLocation::current()) { lane::sync(mask, at); }
/// Replacement of the assembler in trace/warps/warp_vote.h.
inline uint32_t emulated_lanes_before() { return (1u << (threadIdx.x & 31u)) - 1; }

template <class T>
T atomicAdd(T* target, T value) {
    lane::step();
    const T old = *target;
    *target += value;
    return old;
}
template <class T>
T atomicExch(T* target, T value) {
    lane::step();
    return std::exchange(*target, value);
}

inline int __popc(uint32_t x) { return __builtin_popcount(x); }
inline int __ffs(int x) { return __builtin_ffs(x); }
inline int __clz(int x) { return x == 0 ? 32 : __builtin_clz(static_cast<uint32_t>(x)); }
inline int __clzll(long long x) { return x == 0 ? 64 : __builtin_clzll(static_cast<unsigned long long>(x)); }
inline uint32_t __funnelshift_l(uint32_t low, uint32_t high, uint32_t shift) {
    return static_cast<uint32_t>((uint64_t(high) << 32 | low) << (shift & 31) >> 32);
}
/// Permutes bytes. Digit k of the selector chooses byte k of the result from the eight bytes of y and x, or that
/// byte's sign if bit 3 of the digit is set.
inline uint32_t __byte_perm(uint32_t x, uint32_t y, uint32_t selector) {
    const uint64_t bytes = uint64_t(y) << 32 | x;
    uint32_t result = 0;
    for (uint32_t k = 0; k < 4; ++k) {
        const uint32_t digit = selector >> (4 * k), byte = bytes >> (8 * (digit & 7)) & 0xff;
        result |= ((digit & 8) == 0 ? byte : (byte >> 7) * 0xff) << (8 * k);
    }
    return result;
}

struct alignas(8) [[gnu::may_alias]] uint2 {
    uint32_t x, y;
};
struct alignas(16) [[gnu::may_alias]] uint4 {
    uint32_t x, y, z, w;
};
template <class T>
T __ldg(const T* from) {
    return *from;
}

} // namespace pertev
