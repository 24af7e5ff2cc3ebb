#pragma once

// Compares a traversal's closest and any hits with known ones, bit for bit.

#include <doctest/doctest.h>

#include <vector>

#include "tests/support/accept_some.h"
#include "tests/support/stress_meshes.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"

namespace pertev::test {

/// Hits found by testing every triangle.
template <class Accept>
std::vector<Hit> hits_by_brute_force(const std::vector<BvhTriangle>& triangles, const std::vector<Ray>& rays,
                                     const Accept& accept) {
    std::vector<Hit> hits(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
        trace_by_brute_force(triangles, rays[i], kNoHit, accept, hits[i]);
    }
    return hits;
}

template <class Traversal = PlainTraversal, class Accept>
void check_traversal(const SceneTrees<typename Traversal::Tree>& scene, const std::vector<Ray>& rays,
                     const std::vector<Hit>& expected, const Accept& accept) {
    uint64_t wrong = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        Hit hit;
        const bool found = trace_closest<Traversal>(scene, rays[i], accept, hit);
        const bool any = trace_any<Traversal>(scene, rays[i], accept);
        Hit want = expected[i];
        if (want.instance == kNoHit) want.t = rays[i].t_max;
        if (hit == want && found == (want.instance != kNoHit) && any == found) continue;
        if (wrong++ == 0) FAIL_CHECK("ray ", i, ": ", text_of(rays[i]), " t ", hit.t, " want ", want.t, " any ", any);
    }
    CHECK(wrong == 0);
}

/// A scene of one tree over baked triangles.
template <class Tree>
SceneTrees<Tree> scene_of(const Tree& tree) {
    SceneTrees<Tree> scene;
    scene.baked = tree;
    return scene;
}

} // namespace pertev::test
