#pragma once

// What can be switched in every walk of the laboratory. None of it changes a hit.

namespace pertev {

struct WalkOptions {
    bool rta = true; // redundant traversal avoidance: skip what is entered beyond the nearest hit so far; off: only
                     // what is entered beyond the ray's own t_max
    bool near_first = true; // of two children, the one entered first; off: the builder's order
};

} // namespace pertev
