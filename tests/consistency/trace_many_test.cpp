// Many rays that the host traces at once, in flight or in packets, have the hits of single rays, bit for bit:
// degenerate meshes and rays in any mixture, coherent rays, instances.

#include <doctest/doctest.h>

#include <memory>
#include <vector>

#include "accel/builders/build_bvh.h"
#include "accel/builders/builders.h"
#include "accel/bvh/tlas.h"
#include "base/processor.h"
#include "math/random.h"
#include "tests/support/check_traversal.h"
#include "tests/support/options.h"
#include "tests/support/trace_many_16.h"
#include "trace/wide/trace_many.h"

using namespace pertev;
using namespace pertev::test;

namespace {

void check_hits(const std::vector<Ray>& rays, const std::vector<Hit>& expected, const std::vector<Hit>& hits,
                const bool* occluded) {
    uint64_t wrong = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        Hit want = expected[i];
        if (want.instance == kNoHit) want.t = rays[i].t_max;
        if (hits[i] == want && occluded[i] == (want.instance != kNoHit)) continue;
        if (wrong++ == 0) FAIL_CHECK("ray ", i, ": ", text_of(rays[i]), " t ", hits[i].t, " want ", want.t);
    }
    CHECK(wrong == 0);
}

/// Tests packets of eight lanes and, if the processor has them, of sixteen.
template <class Accept>
void check_many(const HostTrees& scene, RayOrder order, const std::vector<Ray>& rays, const std::vector<Hit>& expected,
                const Accept& accept) {
    const auto count = static_cast<uint32_t>(rays.size());
    std::vector<Hit> hits(rays.size());
    const auto occluded = std::make_unique<bool[]>(rays.size());
    const auto ray_of = [&](uint32_t i) { return rays[i]; };
    const auto accept_of = [&](uint32_t) { return accept; };
    trace_closest_many<TraversalOptions{}>(scene, count, order, ray_of, accept_of, hits.data());
    trace_any_many<TraversalOptions{.near_first = false}>(scene, count, order, ray_of, accept_of, occluded.get());
    check_hits(rays, expected, hits, occluded.get());
#if defined(PERTEV_HAS_16_LANES)
    if (!has_sixteen_lanes()) return;
    std::vector<Hit> hits_of_16(rays.size());
    const auto met_of_16 = std::make_unique<bool[]>(rays.size());
    trace_many_by_16(scene, order, rays, accept, hits_of_16.data(), met_of_16.get());
    check_hits(rays, expected, hits_of_16, met_of_16.get());
#endif
}

/// Returns groups of rays around each of `rays`, from one point or in one direction. Axis-parallel rays stay
/// axis-parallel.
std::vector<Ray> groups_around(const std::vector<Ray>& rays, uint32_t seed) {
    Random random(seed);
    std::vector<Ray> groups;
    for (const Ray& first : rays) {
        const float size = length(first.direction), apart = random.unit() < 0.5f ? 1e-4f : 0.05f;
        const bool from_one_point = random.unit() < 0.5f;
        for (int k = 0; k < kWidePacket; ++k) {
            Ray ray = first;
            if (k > 0 && from_one_point) {
                ray.direction = ray.direction + apart * size * random.point(-1, 1);
            } else if (k > 0) {
                ray.origin = ray.origin + apart * random.point(-1, 1);
            }
            groups.push_back(ray);
        }
    }
    return groups;
}

uint64_t count_coherent(const std::vector<Ray>& groups, const HostTrees& scene) {
    uint64_t coherent = 0;
    for (std::size_t i = 0; i < groups.size(); i += kWidePacket) {
        coherent +=
            WidePacket<TraversalOptions{}, ClosestVisitor<AcceptAll>, Floats8>(scene.baked, &groups[i]).is_coherent()
                ? 1
                : 0;
    }
    return coherent;
}

} // namespace

TEST_CASE("tracing many rays at once matches brute force bit for bit") {
    for (const StressMesh& c : stress_meshes()) {
        CAPTURE(c.name);
        const std::vector<Ray> rays = stress_rays(static_cast<uint32_t>(effort(1000, 10'000)), c, 7);
        const WideBvh<8> tree = make_wide_bvh<8>(build_bvh(c.triangles), kSimdCollapse);
        const HostTrees scene = scene_of(view_of(tree));
        const std::vector<Ray> groups = groups_around(
            std::vector<Ray>(rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(rays.size() / 8)), 3);
        if (!tree.nodes.empty()) CHECK(count_coherent(groups, scene) > rays.size() / 8 / 5);
        for (const auto* set : {&rays, &groups}) {
            const std::vector<Hit> all = hits_by_brute_force(c.triangles, *set, AcceptAll{});
            const std::vector<Hit> some = hits_by_brute_force(c.triangles, *set, AcceptSome{});
            for (const RayOrder order : {RayOrder::Scattered, RayOrder::Together}) {
                check_many(scene, order, *set, all, AcceptAll{});
                check_many(scene, order, *set, some, AcceptSome{});
            }
        }
    }
}

TEST_CASE("testing every triangle of a small scene matches brute force bit for bit") {
    std::vector<const TriangleTests*> widths = {&kTestsOf8Rays};
#if defined(PERTEV_HAS_16_LANES)
    if (has_sixteen_lanes()) widths.push_back(&kTestsOf16Rays);
#endif
    for (StressMesh c : stress_meshes()) {
        CAPTURE(c.name);
        c.triangles.resize(std::min<std::size_t>(c.triangles.size(), kMaxTrianglesPerLane * 8));
        const WideBvh<8> tree = make_wide_bvh<8>(build_bvh(c.triangles), kSimdCollapse);
        const HostTrees scene = scene_of(view_of(tree));
        CHECK(is_small(scene) == !c.triangles.empty());
        const std::vector<Ray> rays = stress_rays(static_cast<uint32_t>(effort(1000, 10'000)) + 5, c, 11);
        const std::vector<Hit> all = hits_by_brute_force(c.triangles, rays, AcceptAll{});
        const std::vector<Hit> some = hits_by_brute_force(c.triangles, rays, AcceptSome{});
        check_many(scene, RayOrder::Scattered, rays, all, AcceptAll{});
        check_many(scene, RayOrder::Together, rays, some, AcceptSome{});
        for (const TriangleTests* tests : widths) {
            CAPTURE(tests->lanes);
            std::vector<Hit> hits(rays.size());
            const auto ray_of = [&](uint32_t i) { return rays[i]; };
            const auto accept_of = [](uint32_t) { return AcceptSome{}; };
            const auto make_visitor = [](const AcceptSome& accept, const Ray& ray) {
                return ClosestVisitor<AcceptSome>{accept, Hit{.t = ray.t_max}};
            };
            const auto end = [&](uint32_t i, const auto& visitor) { hits[i] = visitor.best; };
            EveryTriangle<false, decltype(ray_of), decltype(accept_of), decltype(make_visitor), decltype(end)>(
                scene.baked, ray_of, accept_of, make_visitor, end, *tests)
                .run(static_cast<uint32_t>(rays.size()));
            uint64_t wrong = 0;
            for (std::size_t i = 0; i < rays.size(); ++i) {
                Hit want = some[i];
                if (want.instance == kNoHit) want.t = rays[i].t_max;
                wrong += hits[i] == want ? 0 : 1;
                const std::vector<Ray> alike(tests->lanes, rays[i]);
                NearestTriangles found;
                tests->find({scene.baked.triangles, scene.baked.triangle_count}, alike.data(),
                            dominant_axis(rays[i].direction), (1u << tests->lanes) - 1, true, found);
                const bool is_hit = found.triangle[0] != kNoTriangle;
                wrong += is_hit && found.triangle[0] >= scene.baked.triangle_count ? 1 : 0;
                wrong += found.alone == 0 && is_hit != (all[i].instance != kNoHit) ? 1 : 0;
            }
            CHECK(wrong == 0);
        }
    }
}

TEST_CASE("any number of rays can be traced at once, with leaves of any length") {
    const StressMesh mesh = stress_meshes()[3];
    const Bvh bvh = build_bvh(mesh.triangles, {.max_leaf = 30, .leaf_cost = 0.1f});
    const WideBvh<8> tree = make_wide_bvh<8>(bvh, {.max_leaf = 100});
    const HostTrees scene = scene_of(view_of(tree));
    for (const uint32_t count : {0u, 1u, 7u, 8u, 9u, 31u, 33u, 300u}) {
        CAPTURE(count);
        std::vector<Ray> rays = count == 0 ? std::vector<Ray>{} : groups_around(stress_rays(count, mesh, count), count);
        rays.resize(count);
        const std::vector<Hit> expected = hits_by_brute_force(mesh.triangles, rays, AcceptAll{});
        check_many(scene, RayOrder::Scattered, rays, expected, AcceptAll{});
        check_many(scene, RayOrder::Together, rays, expected, AcceptAll{});
    }
}

TEST_CASE("tracing many rays at once finds the nearest of baked triangles and instances") {
    const std::vector<BvhTriangle> baked = make_soup(300, 0), mesh = triangles_of(make_torus(16, 12));
    const WideBvh<8> baked_tree = make_wide_bvh<8>(build_bvh(baked), kSimdCollapse);
    const WideBvh<8> mesh_tree = make_wide_bvh<8>(build_bvh(mesh), kSimdCollapse);
    const Transform place = compose(make_translation({0.5f, 0, 0}), make_scale({0.5f, 2, 1}));
    const std::vector<PlacedBvh> placed = {{place, mesh_tree.bounds, 0, 77}};
    const Tlas top = build_tlas(placed);
    const WideBvhView<8> meshes[] = {view_of(mesh_tree)};
    const std::vector<Ray> rays = groups_around(stress_rays(300, {"soup", baked, {}, 1}, 5), 9);
    for (const bool has_baked : {true, false}) {
        CAPTURE(has_baked);
        HostTrees scene = {{}, top.nodes.data(), top.instances.data(), meshes, top.root, top.reach, top.growth};
        if (has_baked) scene.baked = view_of(baked_tree);
        std::vector<Hit> expected;
        uint64_t of_instance = 0, of_baked = 0;
        for (const Ray& ray : rays) {
            Hit best;
            if (has_baked) trace_by_brute_force(baked, ray, kNoHit, AcceptSome{}, best);
            trace_by_brute_force(mesh, transform_ray(inverse(place), ray), 77, AcceptSome{}, best);
            of_instance += best.instance == 77 ? 1 : 0;
            of_baked += best.instance != 77 && best.instance != kNoHit ? 1 : 0;
            expected.push_back(best);
        }
        CHECK(of_instance > 100);
        CHECK((of_baked > 100) == has_baked);
        check_many(scene, RayOrder::Scattered, rays, expected, AcceptSome{});
        check_many(scene, RayOrder::Together, rays, expected, AcceptSome{});
    }
}
