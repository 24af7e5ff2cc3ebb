#pragma once

// A sink that stops after a number of checks, by any threads.

#include <atomic>
#include <climits>

#include "base/sink.h"

namespace pertev::test {

struct StopAfter final : Sink {
    explicit StopAfter(int times = INT_MAX) : most(times) {}
    bool should_stop() override { return ++asked > most; }
    int most;
    std::atomic<int> asked = 0;
};

} // namespace pertev::test
