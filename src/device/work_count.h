#pragma once

// The number of indices of a launch: a number, or one that earlier work on the device computes, so that the host need
// not wait for it.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

struct WorkCount {
    uint32_t most = 0;                 // the number, or an upper bound of the one on the device
    const uint32_t* counted = nullptr; // in the queue's memory, read when the launch runs; null: the number is `most`

    HD constexpr WorkCount(uint32_t count) : most(count) {} // converts from a plain number
    HD constexpr WorkCount(uint32_t bound, const uint32_t* number) : most(bound), counted(number) {}

    HD uint32_t value() const { return counted != nullptr ? *counted : most; }
};

} // namespace pertev
