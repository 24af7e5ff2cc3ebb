#pragma once

// The lanes and warps that emulated_warp.cpp runs and whose faults emulated_fault.cpp describes. No other file
// includes it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <source_location>
#include <string>

namespace pertev::test {

enum class WarpOperationKind : uint8_t { ActiveMask, Ballot, All, MatchAny, Shuffle, Sync };

/// The point at which a lane waits, and its argument.
struct WarpOperation {
    WarpOperationKind kind;
    uint32_t mask;  // mask that the lane passed
    uint64_t value; // argument; for __activemask a hash of the call stack
    int source;     // for __shfl_sync
    std::source_location at;
    void* const* frame; // frame of the called function
};

struct Fiber {
    void* stack_pointer = nullptr; // while the lane is suspended, six saved registers and its next address are there
    char* stack = nullptr;         // the lowest address of its stack
    std::size_t stack_bytes = 0;
    void* fake_stack = nullptr; // for AddressSanitizer
};

struct EmulatedLane {
    Fiber fiber;
    WarpOperation operation;
    uint64_t result; // the result of the warp operation
};

struct EmulatedWarp {
    uint32_t block, first_thread;
    uint32_t live, ready, waiting,
        pending; // sets of lanes: not ended; able to continue; at a warp operation; at __activemask
    std::array<EmulatedLane, 32> lanes;
};

template <class Do>
void for_each_lane(uint32_t mask, const Do& what) {
    for (; mask != 0; mask &= mask - 1) what(static_cast<unsigned>(__builtin_ctz(mask)));
}

/// Returns the return addresses, from the call in which a lane waits to its first call.
template <class Do>
void for_each_call(const EmulatedLane& lane, const Do& what) {
    const void *above = lane.fiber.stack, *end = lane.fiber.stack + lane.fiber.stack_bytes - 2 * sizeof(void*);
    // The bounds are needed for a caller that was compiled without frame pointers.
    for (void* const* frame = lane.operation.frame; frame > above && frame <= end && frame[1] != nullptr;
         frame = static_cast<void* const*>(frame[0])) {
        what(frame[1]);
        above = frame;
    }
}

/// Describes the waiting lanes with their calls and masks, and the lanes for which they wait.
std::string describe(const EmulatedWarp& warp);

} // namespace pertev::test
