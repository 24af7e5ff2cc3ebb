#pragma once

// Instructions of this computer's processor beyond x86-64-v3, which the program needs.

#include <cstdint>
#include <cstdlib>
#include <string_view>

namespace pertev {

/// The most numbers that host code takes at once.
inline constexpr uint32_t kMaxLanes = 16;

/// Returns whether the processor has the instructions of x86-64-v4 (AVX-512), for code that takes sixteen floats at
/// once.
inline bool has_sixteen_lanes() {
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512vl");
}

/// Returns whether host code takes sixteen floats at once: the processor can, and the environment does not say
/// PERTEV_LANES=8, by which a processor with AVX-512 is timed as one without.
inline bool takes_sixteen_lanes() {
    const char* lanes = std::getenv("PERTEV_LANES");
    return has_sixteen_lanes() && (lanes == nullptr || std::string_view(lanes) != "8");
}

/// Returns whether host code shades several vertices at once; with PERTEV_LANES=1 in the environment, it is timed
/// without.
inline bool shades_in_lanes() {
    const char* lanes = std::getenv("PERTEV_LANES");
    return lanes == nullptr || std::string_view(lanes) != "1";
}

} // namespace pertev
