#pragma once

// How many indices a launch runs over: a number, or one that earlier work on the device finds, so that the host need
// not stop to read it.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

struct WorkCount {
    uint32_t most = 0;                 // the number, or what the one on the device does not pass
    const uint32_t* counted = nullptr; // in the queue's memory, read when the launch runs; null: it is `most`

    HD constexpr WorkCount(uint32_t count) : most(count) {} // a plain number is one
    HD constexpr WorkCount(uint32_t bound, const uint32_t* number) : most(bound), counted(number) {}

    HD uint32_t value() const { return counted != nullptr ? *counted : most; }
};

} // namespace pertev
