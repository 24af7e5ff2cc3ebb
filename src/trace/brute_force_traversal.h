#pragma once

// Tests every triangle of a tree's array, without nodes or order. A tree with spatial splits has a triangle more than
// once; repeated tests change nothing. It is a traversal like the others, for rendering and the laboratory
// (`traversal=brute-force`), with their scenes of instances, visitors and tests. The laboratory checks all traversals,
// this one too, against an oracle that shares none of these (lab/brute_force_rays.h).

#include "trace/intersect/test_leaf.h"
#include "trace/traversal/traversal_options.h"

namespace pertev {

struct TriangleArrayView {
    const BvhTriangle* triangles = nullptr;
    uint32_t count = 0;
};

inline TriangleArrayView triangle_array_of(const Bvh& bvh) {
    return {bvh.triangles.data(), static_cast<uint32_t>(bvh.triangles.size())};
}

template <TraversalOptions kOptions>
struct BruteForceTraversal {
    using Tree = TriangleArrayView;

    template <class Visitor, class Counter>
    HD static bool traverse(const TriangleArrayView& array, const Ray& ray, uint32_t instance, Visitor& visitor,
                            const Counter& counter) {
        using Tests = TestsOf<kOptions>;
        const auto prepared = Tests::make_triangles(ray);
        for (uint32_t i = 0; i < array.count; ++i) {
            bool last;
            if (test_triangle<Tests>(array.triangles + i, ray, prepared, instance, visitor, counter, last)) return true;
        }
        return false;
    }
};

} // namespace pertev
