// Hits agree with Embree's robust single-ray traversal: primitives differ only if both have the same t or the ray hits
// an edge, and the same primitive has the same t. At most 10 rays in 10^7 are exceptions. Equal t means within 1e-5 of
// it, or within 4 units in the last place of the coordinates that it is computed from (Sponza has duplicate walls, and
// rays that start just in front of them).

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "accel/builders/build_bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "base/parallel_for.h"
#include "tests/support/embree_scene.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"
#include "trace/wide/traverse_wide.h"

using namespace pertev;
using namespace pertev::test;

namespace {

struct EmbreeTally {
    uint64_t hits = 0, other = 0, unexplained = 0;
};

/// Returns the smallest weight of the hit's three vertices, which is near 0 on an edge.
float edge_distance(float u, float v) { return min(min(u, v), 1 - u - v); }

template <class Traversal, class Tree>
EmbreeTally compare(const TriangleMesh& mesh, const Bvh& bvh, const Tree& tree, uint64_t count) {
    const EmbreeScene embree(mesh);
    SceneTrees<Tree> scene;
    scene.baked = tree;
    const float reach = bvh.bounds.max_abs(), last_place = 4 * (std::nextafterf(reach, kInfinity) - reach);
    constexpr uint64_t kBlock = 10000;
    std::vector<EmbreeTally> tallies((count + kBlock - 1) / kBlock);
    parallel_for(tallies.size(), 1, [&](uint64_t block) {
        Random random(static_cast<uint32_t>(block) * 2654435761u + 5);
        EmbreeTally& tally = tallies[block];
        for (uint64_t i = 0; i < kBlock; ++i) {
            Ray ray;
            const Vec3 size = bvh.bounds.size();
            ray.origin = bvh.bounds.lo + Vec3{size.x * random.unit(), size.y * random.unit(), size.z * random.unit()};
            ray.direction = random.direction();
            Hit hit;
            trace_closest<Traversal>(scene, ray, AcceptAll{}, hit);
            const Hit want = embree.closest(ray);
            const bool found = hit.instance != kNoHit, expected = want.instance != kNoHit;
            tally.hits += found ? 1 : 0;
            const bool same_t = found && expected && pertev::abs(hit.t - want.t) <= max(1e-5f * hit.t, last_place);
            if (found == expected && (!found || hit.primitive == want.primitive)) {
                if (found && !same_t) ++tally.unexplained;
                continue;
            }
            ++tally.other;
            const bool on_edge = (found && pertev::abs(edge_distance(hit.u, hit.v)) < 1e-4f) ||
                                 (expected && pertev::abs(edge_distance(want.u, want.v)) < 1e-4f);
            if (!same_t && !on_edge) ++tally.unexplained;
        }
    });
    EmbreeTally sum;
    for (const EmbreeTally& t : tallies) {
        sum.hits += t.hits;
        sum.other += t.other;
        sum.unexplained += t.unexplained;
    }
    MESSAGE(count, " rays: ", sum.hits, " hits, ", sum.other, " on another primitive, ", sum.unexplained,
            " unexplained");
    return sum;
}

} // namespace

TEST_CASE("hits on a torus agree with Embree's") {
    const uint64_t count = effort(300'000, 10'000'000);
    const TriangleMesh mesh = make_torus(300, 200);
    const Bvh bvh = build_bvh(triangles_of(mesh));
    const EmbreeTally tally = compare<PlainTraversal>(mesh, bvh, view_of(bvh), count);
    CHECK(tally.hits > count / 10);
    CHECK(tally.unexplained <= std::max<uint64_t>(1, count / 1'000'000));
}

TEST_CASE("hits in Sponza agree with Embree's") {
    const auto path = test_scene("crytek-sponza/sponza.obj");
    if (!path) return;
    const uint64_t count = effort(1'000'000, 10'000'000);
    const TriangleMesh mesh = read_obj_geometry(*path);
    const Bvh bvh = build_bvh(triangles_of(mesh));
    const auto wide = make_wide_bvh<kWideChildren>(bvh, kSimdCollapse);
    const EmbreeTally tally = compare<Wide8SimdTraversal<TraversalOptions{}>>(mesh, bvh, view_of(wide), count);
    CHECK(tally.hits > count / 2);
    CHECK(tally.unexplained <= std::max<uint64_t>(1, count / 1'000'000));
}
