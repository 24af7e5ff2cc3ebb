#pragma once

// What can be switched in every walk of the laboratory. Only `exact` changes hits.

#include <type_traits>

#include "trace/ray_tests.h"

namespace pertev {

struct WalkOptions {
    bool rta = true; // redundant traversal avoidance: skip what is entered beyond the nearest hit so far; off: only
                     // what is entered beyond the ray's own t_max
    bool near_first = true; // of several children, the one entered first; off: the builder's order
    bool exact = true;      // ExactTests; off: FastTests
};

/// What an any-hit search is compiled with: it has no nearest hit to skip beyond, so its stack need hold no entries.
constexpr WalkOptions for_any_hit(WalkOptions options) {
    options.rta = false;
    return options;
}

template <WalkOptions kOptions>
using TestsOf = std::conditional_t<kOptions.exact, ExactTests, FastTests>;

/// What a box's entry is compared with: greater is skipped.
template <WalkOptions kOptions, class Visitor>
HD inline float skip_beyond(const Visitor& visitor, const Ray& ray) {
    return kOptions.rta ? visitor.limit() : ray.t_max;
}

} // namespace pertev
