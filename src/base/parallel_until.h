#pragma once

// A parallel loop that a sink ends. The sink is checked at every 2^16th iteration, on whichever thread runs them.

#include <cstdint>

#include "base/parallel_for.h"
#include "base/sink.h"

namespace pertev {

/// Runs body(i) as parallel_for does, until `sink` stops it. Then throws Error(Interrupted); some iterations are
/// missing.
template <class Body>
void parallel_until(uint64_t count, uint64_t grain, Sink& sink, const Body& body) {
    parallel_for(count, grain, [&](uint64_t i) {
        sink.check_at(i);
        body(i);
    });
}

} // namespace pertev
