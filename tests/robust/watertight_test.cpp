// A ray that starts inside a closed mesh must hit it. Rays are aimed where leaks live: at vertices and along edges,
// with the mesh at the origin, 1 km and 150 km away, baked and as an instance. One miss fails the test and prints the
// ray as hex floats.

#include <doctest/doctest.h>

#include <atomic>
#include <cstdio>
#include <mutex>
#include <string>

#include "accel/bvh/build_bvh.h"
#include "accel/bvh/top_level_bvh.h"
#include "accel/bvh/wide_bvh.h"
#include "base/parallel_for.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "trace/trace_any.h"
#include "trace/trace_closest.h"

using namespace pertev;
using namespace pertev::test;

namespace {

enum class Aim { Vertex, Edge, Anywhere };

Ray ray_from_inside(const TriangleMesh& mesh, Vec3 centre, Aim aim, Random& random) {
    Ray ray;
    ray.origin = centre + 0.5f * random.point(-1, 1);
    const uint32_t triangle = random.below(mesh.triangle_count());
    const int corner = static_cast<int>(random.below(3));
    const Vec3 a = mesh.corner(triangle, corner), b = mesh.corner(triangle, (corner + 1) % 3);
    switch (aim) {
    case Aim::Vertex:
        ray.direction = a - ray.origin;
        break;
    case Aim::Edge:
        ray.direction = lerp(a, b, random.unit()) - ray.origin;
        break;
    case Aim::Anywhere:
        ray.direction = random.direction();
        break;
    }
    if (random.below(8) == 0) { // along an axis or in a plane of boxes: no normalisation
        (random.below(2) ? ray.direction.x : ray.direction.y) = 0;
        if (random.below(2)) ray.direction.z = random.below(2) ? 0.0f : -0.0f;
        if (ray.direction == Vec3{}) ray.direction = {0, 1, 0};
    }
    return ray;
}

std::string text_of(const Ray& r) {
    char text[256];
    std::snprintf(text, sizeof text, "origin %a %a %a direction %a %a %a", static_cast<double>(r.origin.x),
                  static_cast<double>(r.origin.y), static_cast<double>(r.origin.z), static_cast<double>(r.direction.x),
                  static_cast<double>(r.direction.y), static_cast<double>(r.direction.z));
    return text;
}

/// Traces `count` rays and reports the first that is lost.
void check_none_is_lost(const SceneBvhView& scene, const TriangleMesh& mesh, Vec3 centre, Aim aim, uint64_t count) {
    constexpr uint64_t kBlock = 4096; // one generator a block: the rays do not depend on the threads
    std::atomic<uint64_t> lost{0};
    std::mutex mutex;
    std::string first;
    parallel_for((count + kBlock - 1) / kBlock, 1, [&](uint64_t block) {
        Random random(static_cast<uint32_t>(block * 3 + static_cast<uint64_t>(aim)) * 2654435761u);
        for (uint64_t i = 0; i < kBlock; ++i) {
            const Ray ray = ray_from_inside(mesh, centre, aim, random);
            Hit hit;
            const bool found = trace_closest(scene, ray, AcceptAll{}, hit);
            const bool any = i % 8 != 0 || trace_any(scene, ray, AcceptAll{});
            if (found && any) continue;
            if (lost++ == 0) {
                const std::lock_guard lock(mutex);
                first = text_of(ray);
            }
        }
    });
    CHECK_MESSAGE(lost == 0, lost.load(), " lost, one of them: ", first);
}

} // namespace

TEST_CASE("no ray leaves a closed sphere") {
    for (const float away_m : {0.0f, 1e3f, 1.5e5f}) {
        const Vec3 centre = {away_m, 0, -1.5f * away_m};
        // At 150 km a float is 1/64 m: smaller faces would fold over each other.
        const TriangleMesh sphere = make_sphere(away_m > 1e4f ? 2 : 5, centre, 1);
        const Bvh bvh = build_bvh(triangles_of(sphere));
        const std::vector<WideBvhNode<8>> wide_nodes = make_wide_nodes(bvh);
        SceneBvhView scene;
        scene.baked = view_of(bvh);
        for (const bool wide : {false, true}) {
            if (wide) scene.baked.wide = wide_nodes.data();
            for (const Aim aim : {Aim::Vertex, Aim::Edge, Aim::Anywhere}) {
                CAPTURE(away_m);
                CAPTURE(static_cast<int>(aim));
                CAPTURE(wide);
                check_none_is_lost(scene, sphere, centre, aim, effort(500'000, 6'000'000));
            }
        }
    }
}

TEST_CASE("no ray leaves a closed sphere that is an instance") {
    for (const float away_m : {0.0f, 1e3f, 1.5e5f}) {
        const Vec3 centre = {away_m, 0, -1.5f * away_m};
        const TriangleMesh local = make_sphere(4, {3, 4, 5}, 2);
        const Transform place = compose(
            make_translation(centre), compose(make_rotation(0.48f, 0.6f, 0, 0.64f), // unit
                                              compose(make_scale({0.5f, 0.5f, 0.5f}), make_translation({-3, -4, -5}))));
        TriangleMesh world = local;
        for (Vec3& v : world.positions) v = transform_point(place, v);
        const Bvh bvh = build_bvh(triangles_of(local));
        const BvhView mesh = view_of(bvh);
        const PlacedBvh placed[] = {{place, bvh.bounds, 0, 0}};
        const TopLevelBvh top = build_top_level_bvh(placed);
        const SceneBvhView scene = {{}, top.nodes.data(), top.instances.data(), &mesh, top.root, top.reach, top.growth};
        for (const Aim aim : {Aim::Vertex, Aim::Edge, Aim::Anywhere}) {
            CAPTURE(away_m);
            CAPTURE(static_cast<int>(aim));
            check_none_is_lost(scene, world, centre, aim, effort(200'000, 2'000'000));
        }
    }
}
