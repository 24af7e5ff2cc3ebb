// Traversals as stages over rays: hits and counts equal those of direct calls, and times are measured.

#include "lab/measure_rays.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>

#include "accel/builders/build_bvh.h"
#include "tests/support/check_traversal.h"
#include "tests/support/make_tracer.h"

using namespace pertev;
using namespace pertev::test;

namespace {

RaySet random_rays(uint32_t count, bool any_hit) {
    Random random(11);
    RaySet set{"random", any_hit};
    for (uint32_t i = 0; i < count; ++i) {
        const Vec3 origin = random.point(-4, 4);
        set.rays.push_back({origin, 0, random.point(-1, 1) - origin, i % 3 == 0 ? 0.8f : kInfinity});
    }
    return set;
}

} // namespace

TEST_CASE("the traversal of a ray set has the hits and the work of separate traversals of its rays") {
    const Bvh bvh = build_bvh(triangles_of(make_torus(32, 24)));
    const SceneBvhView binary = scene_of(view_of(bvh));
    Queue queue = Queue::make_cpu();
    const Tracer tracer = make_tracer(queue, bvh);
    for (const bool any : {false, true}) {
        const RaySet set = random_rays(5000, any);
        RaysOnDevice rays(queue, set);
        rays.trace(make_tracer(queue, bvh, kSimdTracer));
        const std::vector<RayHit> hits = rays.hits();
        rays.trace(tracer);
        CHECK(hits == rays.hits());
        const std::vector<RayWork> work = rays.count_work(tracer);
        uint64_t wrong = 0, nodes = 0, triangles = 0, found = 0;
        uint32_t most = 0;
        for (std::size_t i = 0; i < set.rays.size(); ++i) {
            Hit hit;
            uint64_t n = 0, t = 0;
            const TraversalCounter counter{&n, &t};
            RayHit want;
            if (any) {
                want = {0, trace_any(binary, set.rays[i], pertev::AcceptAll{}, counter) ? 0 : kNoHit, 0};
            } else {
                trace_closest(binary, set.rays[i], pertev::AcceptAll{}, hit, counter);
                want = {hit.t, hit.instance, hit.primitive};
            }
            wrong += hits[i] != want || work[i].nodes != n || work[i].triangles != t ? 1 : 0;
            nodes += n, triangles += t, found += want.is_hit() ? 1 : 0;
            most = std::max(most, work[i].nodes);
        }
        CHECK(wrong == 0);
        CHECK(found > 500);
        CHECK(found < 4500);
        const WorkSummary summary = summarize_work(work);
        CHECK(summary.nodes == doctest::Approx(static_cast<double>(nodes) / 5000));
        CHECK(summary.triangles == doctest::Approx(static_cast<double>(triangles) / 5000));
        CHECK(summary.max_nodes == most);
        CHECK(hit_share(hits) == doctest::Approx(static_cast<double>(found) / 5000));
    }
}

TEST_CASE("an empty ray set has no hits, no work and no time") {
    Queue queue = Queue::make_cpu();
    const RaySet none{"none"};
    RaysOnDevice rays(queue, none);
    const Tracer tracer = make_tracer(queue, Bvh{});
    rays.trace(tracer);
    CHECK(rays.hits().empty());
    CHECK(hit_share({}) == 0);
    CHECK(summarize_work(rays.count_work(tracer)).nodes == 0);
    CHECK(rays.time(tracer, 0, 1).median < 0.1);
}

TEST_CASE("runs are timed one by one, and the median of an even number is the mean of the middle two") {
    Queue queue = Queue::make_cpu();
    int calls = 0;
    const RunTimes times = time_runs(queue, 2, 5, [&] {
        // The one slow run must be the longest, and warm-up runs must not count.
        const auto until = std::chrono::steady_clock::now() + std::chrono::milliseconds(calls < 2    ? 60
                                                                                        : calls == 4 ? 30
                                                                                                     : 2);
        while (std::chrono::steady_clock::now() < until) {
        }
        ++calls;
    });
    CHECK(calls == 7);
    CHECK(times.runs == 5);
    CHECK(times.least >= 0.002);
    CHECK(times.greatest >= 0.030);
    CHECK(times.median < times.greatest);
    const RunTimes four = summarize_runs({4, 1, 3, 2});
    CHECK(four.median == 2.5);
    CHECK(four.least == 1);
    CHECK(four.greatest == 4);
    CHECK(summarize_runs({7}).median == 7);
    CHECK(summarize_runs({5, 1, 2}).median == 2);
}
