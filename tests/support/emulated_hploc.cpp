// Compiles tracer/hploc/warp_kernels.h as device code (tests/support/emulated_device.h).

#include "tests/support/emulated_hploc.h"

#include "tests/support/emulated_device.h" // device code from here on

#include <cstring>
#include <vector>

namespace pertev {

template <class T>
T shuffled(T value, int source, CodeLocation at) {
    uint32_t words[sizeof(T) / 4];
    std::memcpy(words, &value, sizeof(T));
    for (uint32_t& word : words) word = lane::shuffle(0xffffffffu, word, source, at);
    std::memcpy(&value, words, sizeof(T));
    return value;
}
inline float __shfl_sync(uint32_t, float value, int source, CodeLocation at = CodeLocation::current()) {
    return shuffled(value, source, at);
}
template <class T>
T __shfl_xor_sync(uint32_t, T value, uint32_t step, CodeLocation at = CodeLocation::current()) {
    return shuffled(value, static_cast<int>((threadIdx.x & 31u) ^ step), at);
}
template <class T>
T __shfl_up_sync(uint32_t, T value, uint32_t step, uint32_t width = 32, CodeLocation at = CodeLocation::current()) {
    const uint32_t of_group = threadIdx.x % width;
    return shuffled(value, static_cast<int>((threadIdx.x & 31u) - (of_group >= step ? step : 0)), at);
}
inline bool __any_sync(uint32_t mask, bool mine, CodeLocation at = CodeLocation::current()) {
    return lane::ballot(mask, mine, at) != 0;
}
inline void __threadfence() { lane::step(); }
inline void __nanosleep(uint32_t) { lane::step(); }

inline uint2 make_uint2(uint32_t x, uint32_t y) { return {x, y}; }
struct float4 {
    float x, y, z, w;
};
inline float4 make_float4(float x, float y, float z, float w) { return {x, y, z, w}; }
inline uint32_t __float_as_uint(float x) { return __builtin_bit_cast(uint32_t, x); }
inline float __uint_as_float(uint32_t x) { return __builtin_bit_cast(float, x); }

} // namespace pertev

#define __shared__ static // for kernels whose bodies run here with their own memory
#include "tracer/hploc/warp_kernels.h"

#include "base/remark.cpp" // the sink of a build's settings calls this

#undef pertev

namespace pertev::test {

namespace emulated = pertev_emulated::hploc;

std::string climb_on_emulated_warps(const void* of_host, uint32_t triangles, uint32_t seed) {
    const auto& climb = *static_cast<const emulated::Climb*>(of_host);
    const uint32_t blocks = (triangles + emulated::kClimbThreads - 1) / emulated::kClimbThreads;
    std::vector<emulated::WarpClusters> memory(blocks * emulated::kClimbThreads / 32);
    return run_warps({.blocks = blocks, .threads = emulated::kClimbThreads, .seed = seed}, [&] {
        const uint32_t thread = lane::block_index.x * emulated::kClimbThreads + lane::thread_index.x;
        emulated::climb_together(climb, memory[thread / 32]);
    });
}

std::string emit_on_emulated_warps(const void* of_host, uint32_t warps, uint32_t seed) {
    const auto& emit = *static_cast<const emulated::EmitWide*>(of_host);
    std::vector<emulated::GroupMemory> memory(warps * emulated::kNodesAtOnce);
    return run_warps({.blocks = warps, .threads = 32, .seed = seed}, [&] {
        emulated::emit_together(emit, memory[lane::block_index.x * emulated::kNodesAtOnce + lane::thread_index.x / 8]);
    });
}

} // namespace pertev::test
