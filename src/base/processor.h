#pragma once

// Instructions of this computer's processor beyond x86-64-v3, which the program needs.

#include <cstdint>

namespace pertev {

/// The most numbers that host code takes at once.
inline constexpr uint32_t kMaxLanes = 16;

/// Returns whether it has the instructions of x86-64-v4 (AVX-512), for code that takes sixteen floats at once.
inline bool has_sixteen_lanes() {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}

} // namespace pertev
