#pragma once

// What can be switched in every walk, at compile time. Only `tests` changes hits.

#include <type_traits>

#include "trace/intersect/ray_tests.h"
#include "trace/intersect/woop_tests.h"

namespace pertev {

enum class TestKind {
    Exact,
    Fast,
    Woop, // for the walks of Aila and Laine
};

struct WalkOptions {
    bool rta = true; // redundant traversal avoidance: skip what is entered beyond the nearest hit so far; off: only
                     // what is entered beyond the ray's own t_max
    bool near_first = true; // of several children, the one entered first; off: the builder's order. What searches for
                            // any hit ask for beside that: trace_any.h
    TestKind tests = TestKind::Exact;
    bool rta_at_pops = true; // off: RTA at nodes alone; the compressed walk has that, the others do not
    bool any_hit = false;    // what for_any_hit makes of the others

    constexpr bool operator==(const WalkOptions&) const = default;
    constexpr bool is_exact() const { return tests == TestKind::Exact; }
};

/// What an any-hit search is compiled with: it has no nearest hit to skip beyond, so its stack need hold no entries.
constexpr WalkOptions for_any_hit(WalkOptions options) {
    options.rta = false;
    options.rta_at_pops = true;
    options.any_hit = true;
    return options;
}

template <WalkOptions kOptions>
using TestsOf = std::conditional_t<kOptions.tests == TestKind::Woop, WoopTests,
                                   std::conditional_t<kOptions.is_exact(), ExactTests, FastTests>>;

/// The binary tree with what the tests want of its triangles.
template <WalkOptions kOptions>
using BinaryTreeOf = std::conditional_t<kOptions.tests == TestKind::Woop, WoopBvhView, BvhView>;

/// What a box's entry is compared with: greater is skipped.
template <WalkOptions kOptions, class Visitor>
HD inline float skip_beyond(const Visitor& visitor, const Ray& ray) {
    return kOptions.rta ? visitor.limit() : ray.t_max;
}

} // namespace pertev
