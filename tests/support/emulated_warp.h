#pragma once

// A GPU's warps on the host, for tests: every lane is a fiber with a stack of its own, and lanes meet only where CUDA
// says that they do. What CUDA leaves open is chosen at random from a seed: which lane and which warp goes on next, how
// many warps are there at once, and what __activemask() answers: any lanes at that same call, sometimes all that can
// come, sometimes fewer, sometimes one. Stricter than CUDA: a mask may not name lanes that have ended. As in PTX,
// lanes may come to a meeting from different places of the source.
//
// What would be undefined or hang on a GPU is reported as a fault that tells which lanes wait where, with which masks.
// A lane that spins without meeting anyone is not noticed. tests/support/emulated_device.h lets the renderer's own
// kernels run on it.

#include <cstdint>
#include <functional>
#include <source_location>
#include <string>

namespace pertev::test {

struct EmulatedLaunch {
    uint32_t blocks = 1, threads = 32;      // threads a block, a multiple of 32
    uint32_t seed = 0;                      // equal seeds, equal runs
    uint64_t max_steps = uint64_t(1) << 27; // meetings and atomics; more is a fault, as of lanes that wait in a loop
};

/// Runs kernel() once a thread. Returns what went wrong, or nothing. Lanes do not return from a fault, so a kernel's
/// objects have no destructors, as on a device.
std::string run_warps(const EmulatedLaunch& launch, const std::function<void()>& kernel);

/// Functions that a kernel calls. Those with a mask wait until each of its lanes has made the same call with the same
/// mask.
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
/// The value of lane `source`, one of the mask.
uint32_t shuffle(uint32_t mask, uint32_t value, int source, CodeLocation at = CodeLocation::current());
void sync(uint32_t mask, CodeLocation at = CodeLocation::current());
/// Others may run before this lane goes on, as around an atomic operation.
void step();

} // namespace lane

} // namespace pertev::test
