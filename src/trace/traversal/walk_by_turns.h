#pragma once

// Runs a traversal that can be suspended between two turns (interface: trace/dynamic_fetch.h) from root to end.

#include <cstdint>

#include "base/host_device.h"
#include "trace/intersect/ray.h"
#include "trace/warps/warp_vote.h"

namespace pertev {

/// Returns true if the visitor ended it.
template <class Walk, class Visitor, class Counter>
HD inline bool walk_by_turns(const typename Walk::Tree& tree, const Ray& ray, uint32_t instance, Visitor& visitor,
                             const Counter& counter) {
    typename Walk::Place::Slot slots[Walk::Place::kSlots];
    typename Walk::Place place(slots);
    Walk::start(tree, ray, visitor, place);
    while (!place.is_done()) {
        const LaneMask lanes = lanes_here();
        if (Walk::turn(tree, ray, instance, place, visitor, counter, lanes, count_lanes(lanes))) return true;
    }
    return false;
}

} // namespace pertev
