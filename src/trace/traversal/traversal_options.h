#pragma once

// Compile-time switches of every traversal. Only `tests` affects hits.

#include <type_traits>

#include "trace/intersect/ray_tests.h"
#include "trace/intersect/woop_tests.h"

namespace pertev {

enum class TestKind {
    Exact,
    Fast,
    Woop, // for the traversals of Aila and Laine
};

struct TraversalOptions {
    bool rta = true; // redundant traversal avoidance: skips nodes entered beyond the nearest hit so far; off: only
                     // those beyond the ray's own t_max
    bool near_first = true; // visits the child that is entered first; off: the builder's order. Any-hit searches may
                            // want far children first: trace_any.h
    TestKind tests = TestKind::Exact;
    bool rta_at_pops = true; // off: RTA only at nodes, supported by the compressed traversal only
    bool any_hit = false;    // set by for_any_hit

    constexpr bool operator==(const TraversalOptions&) const = default;
    constexpr bool is_exact() const { return tests == TestKind::Exact; }
};

/// Options of an any-hit search: it has no nearest hit to compare with, so its stack need not hold entry parameters.
constexpr TraversalOptions for_any_hit(TraversalOptions options) {
    options.rta = false;
    options.rta_at_pops = true;
    options.any_hit = true;
    return options;
}

template <TraversalOptions kOptions>
using TestsOf = std::conditional_t<kOptions.tests == TestKind::Woop, WoopTests,
                                   std::conditional_t<kOptions.is_exact(), ExactTests, FastTests>>;

/// The binary tree with the triangle data that the tests need.
template <TraversalOptions kOptions>
using BinaryTreeOf = std::conditional_t<kOptions.tests == TestKind::Woop, WoopBvhView, BvhView>;

/// The limit of a box's entry parameter; boxes with a greater one are skipped.
template <TraversalOptions kOptions, class Visitor>
HD inline float skip_beyond(const Visitor& visitor, const Ray& ray) {
    return kOptions.rta ? visitor.limit() : ray.t_max;
}

} // namespace pertev
