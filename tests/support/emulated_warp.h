#pragma once

// A GPU's warps on the host, for tests. Every lane is a fiber with its own stack, and lanes synchronise only where
// CUDA specifies it. What CUDA leaves open is chosen at random from a seed: which lane and which warp continue, how
// many warps are resident, and the result of __activemask(), which is any set of lanes at the same call: sometimes all
// that can arrive, sometimes fewer, sometimes one. Unlike in CUDA, a mask must not name lanes that have ended. As in
// PTX, lanes may reach a warp operation from different places of the source.
//
// Undefined behaviour and hangs on a GPU are reported as a fault that lists which lanes wait where, with which masks.
// A lane that spins without a warp operation is not detected. With tests/support/emulated_device.h the renderer's
// kernels run on it.

#include <cstdint>
#include <functional>
#include <source_location>
#include <string>

namespace pertev::test {

struct EmulatedLaunch {
    uint32_t blocks = 1, threads = 32; // threads per block, a multiple of 32
    uint32_t seed = 0;                 // equal seeds, equal runs
    uint64_t max_steps =
        uint64_t(1) << 27; // maximum number of warp operations and atomics; more is a fault, such as an endless loop
};

/// Runs kernel() once per thread. Returns the fault, if any. Lanes do not return from a fault, so objects of a kernel
/// must not need destructors.
std::string run_warps(const EmulatedLaunch& launch, const std::function<void()>& kernel);

/// Functions that a kernel calls. Functions with a mask wait until each of its lanes has made the same call with the
/// same mask.
namespace lane {

using CodeLocation = std::source_location;

struct Index {
    uint32_t x;
};
extern Index thread_index, block_index, block_size; // indices of the running lane

uint32_t active_mask(CodeLocation at = CodeLocation::current());
uint32_t ballot(uint32_t mask, bool mine, CodeLocation at = CodeLocation::current());
bool all(uint32_t mask, bool mine, CodeLocation at = CodeLocation::current());
uint32_t match_any(uint32_t mask, uint64_t key, CodeLocation at = CodeLocation::current());
/// Returns the value of lane `source`, which is in the mask.
uint32_t shuffle(uint32_t mask, uint32_t value, int source, CodeLocation at = CodeLocation::current());
void sync(uint32_t mask, CodeLocation at = CodeLocation::current());
/// Lets other lanes run before this lane continues, as around an atomic operation.
void step();

} // namespace lane

} // namespace pertev::test
