#pragma once

// Runs a traversal that can be suspended between two turns (interface: trace/dynamic_fetch.h) from root to end.

#include <cstdint>

#include "base/host_device.h"
#include "trace/intersect/ray.h"
#include "trace/warps/warp_vote.h"

namespace pertev {

/// Traverses a tree step by step. Returns true if the visitor ended the traversal.
template <class Traversal, class Visitor, class Counter>
HD inline bool traverse_by_steps(const typename Traversal::Tree& tree, const Ray& ray, uint32_t instance,
                                 Visitor& visitor, const Counter& counter) {
    typename Traversal::State::Slot slots[Traversal::State::kSlots];
    typename Traversal::State state(slots);
    Traversal::start(tree, ray, visitor, state);
    while (!state.is_done()) {
        const LaneMask lanes = lanes_here();
        if (Traversal::step(tree, ray, instance, state, visitor, counter, lanes, count_lanes(lanes))) return true;
    }
    return false;
}

} // namespace pertev
