#pragma once

// The builder's kernels for CUDA (tracer/hploc/warp_kernels.h) on emulated warps.

#include <cstdint>
#include <string>

namespace pertev::test {

/// Runs launch_climb and launch_emit as on a GPU, after clearing the memory of a hploc::Climb for this number of
/// triangles and of a hploc::EmitWide with the device's layouts. Returns the fault, if any.
std::string climb_on_emulated_warps(const void* climb, uint32_t triangles, uint32_t seed);
std::string emit_on_emulated_warps(const void* emit, uint32_t warps, uint32_t seed);

} // namespace pertev::test
