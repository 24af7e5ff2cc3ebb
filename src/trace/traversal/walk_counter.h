#pragma once

// What a walk did, for tests and benchmarks. A walk tells its counter of each node and triangle that it is about to
// test, and where that lies.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

/// Costs nothing.
struct NoWalkCounter {
    HD void add_node(const void*) const {}
    HD void add_triangle(const void*) const {}
};

/// What one ray cost: nodes and triangles that were tested.
struct RayWork {
    uint32_t nodes = 0, triangles = 0;
};

struct WalkCounter {
    uint64_t* nodes;
    uint64_t* triangles;
    HD void add_node(const void*) const { ++*nodes; }
    HD void add_triangle(const void*) const { ++*triangles; }
};

} // namespace pertev
