#pragma once

// Counters of a traversal's work, for tests and benchmarks. A traversal reports each node and triangle before it
// tests it, with its address.

#include <cstdint>

#include "base/host_device.h"

namespace pertev {

/// A counter that counts nothing, at no cost.
struct NoTraversalCounter {
    HD void add_node(const void*) const {}
    HD void add_triangle(const void*) const {}
};

/// The work of one ray: numbers of nodes and triangles tested.
struct RayWork {
    uint32_t nodes = 0, triangles = 0;
};

struct TraversalCounter {
    uint64_t* nodes;
    uint64_t* triangles;
    HD void add_node(const void*) const { ++*nodes; }
    HD void add_triangle(const void*) const { ++*triangles; }
};

} // namespace pertev
