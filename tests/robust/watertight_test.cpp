// A ray that starts inside a closed mesh must hit it. Rays are aimed where leaks occur: at vertices and along edges,
// with the mesh at the origin, 1 km and 150 km away, baked and as an instance. They are traced like the laboratory's
// rays, with --device cuda on the GPU, by the traversal of pictures (on the CPU that of wide nodes) and by that of
// binary nodes. One miss fails the test and prints the ray as hex floats.

#include <doctest/doctest.h>

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "base/parallel_for.h"
#include "lab/measure_rays.h"
#include "math/random.h"
#include "tests/support/make_tracer.h"
#include "tests/support/meshes.h"
#include "tests/support/options.h"
#include "tests/support/render_scenes.h"
#include "tracer/tracer_choice.h"

using namespace pertev;
using namespace pertev::test;

namespace {

enum class Aim { Vertex, Edge, Bent, Anywhere };

/// Returns ray `i` of the set numbered `set`. All rays of all sets differ.
Ray ray_from_inside(const TriangleMesh& mesh, Vec3 centre, Aim aim, uint32_t i, uint32_t set) {
    const Hash4 a = hash_words(i, set, static_cast<uint32_t>(aim), 0), b = hash_words(i, set, 1, 1);
    Ray ray;
    ray.origin = centre + Vec3{unit_interval(a.x) - 0.5f, unit_interval(a.y) - 0.5f, unit_interval(a.z) - 0.5f};
    const auto triangle = static_cast<uint32_t>((uint64_t(a.w) * mesh.triangle_count()) >> 32);
    const int corner = static_cast<int>(b.x % 3);
    const Vec3 from = mesh.corner(triangle, corner), to = mesh.corner(triangle, (corner + 1) % 3);
    switch (aim) {
    case Aim::Vertex:
        ray.direction = from - ray.origin;
        break;
    case Aim::Edge:
        ray.direction = lerp(from, to, unit_interval(b.y)) - ray.origin;
        break;
    case Aim::Bent: // from an edge, along an axis or into a plane of boxes; no normalisation
        ray.direction = lerp(from, to, unit_interval(b.y)) - ray.origin;
        ((b.z & 1) != 0 ? ray.direction.x : ray.direction.y) = 0;
        if ((b.z & 2) != 0) ray.direction.z = (b.z & 4) != 0 ? 0.0f : -0.0f;
        if (ray.direction == Vec3{}) ray.direction = {0, 1, 0};
        break;
    case Aim::Anywhere:
        ray.direction = sample_uniform_sphere({unit_interval(b.y), unit_interval(b.w)});
        break;
    }
    return ray;
}

std::string text_of(const Ray& r) {
    return fmt::format("origin {:a} {:a} {:a} direction {:a} {:a} {:a}", r.origin.x, r.origin.y, r.origin.z,
                       r.direction.x, r.direction.y, r.direction.z);
}

/// A closed mesh, instance 0 of a scene, about `centre`. `world` is its mesh in world space.
struct ClosedInstance {
    Queue queue = requested_queue();
    Messages messages;
    PreparedScene prepared;
    TriangleMesh world;
    Vec3 centre;

    ClosedInstance(const Scene& scene, TriangleMesh in_world, Vec3 about)
        : prepared(prepare_scene(scene, {.bvh = {}, .bvh_cache = {}, .keep_coordinates = true}, messages)),
          world(std::move(in_world)), centre(about) {}

    /// Returns the rays that miss the mesh.
    std::vector<Ray> lost(const Tracer& tracer, const RaySet& set) {
        RaysOnDevice rays(queue, set);
        rays.trace(tracer);
        const std::vector<RayHit> hits = rays.hits();
        std::vector<Ray> lost;
        for (std::size_t i = 0; i < hits.size(); ++i) {
            if (hits[i].instance != 0) lost.push_back(set.rays[i]);
        }
        return lost;
    }

    /// Traces rays [0, count) of the set, every eighth also as any-hit ray, and reports one of the lost rays.
    void check_none_is_lost(const Tracer& tracer, Aim aim, uint64_t count, uint32_t set_number) {
        constexpr uint64_t kPiece = 1 << 18;
        std::vector<Ray> lost_rays;
        for (uint64_t begin = 0; begin < count; begin += kPiece) {
            RaySet set{"from inside", false, std::vector<Ray>(std::min(kPiece, count - begin))};
            parallel_for(set.rays.size(), 4096, [&](uint64_t i) {
                set.rays[i] = ray_from_inside(world, centre, aim, static_cast<uint32_t>(begin + i), set_number);
            });
            for (const bool any_hit : {false, true}) {
                set.any_hit = any_hit;
                if (any_hit) set.rays.resize(set.rays.size() / 8);
                const std::vector<Ray> more = lost(tracer, set);
                lost_rays.insert(lost_rays.end(), more.begin(), more.end());
            }
        }
        CHECK_MESSAGE(lost_rays.empty(), lost_rays.size(), " lost, one of them: ", text_of(lost_rays.front()));
    }

    /// Returns `count` rays at vertices, as many at edges, and a few others.
    void check_tracer(const Combination& combination, uint64_t count, uint32_t set_number) {
        const Tracer tracer = make_tracer(queue, prepared, combination);
        for (const Aim aim : {Aim::Vertex, Aim::Edge, Aim::Bent, Aim::Anywhere}) {
            CAPTURE(static_cast<int>(aim));
            const bool is_aimed = aim == Aim::Vertex || aim == Aim::Edge;
            check_none_is_lost(tracer, aim, is_aimed ? count : count / 20, set_number);
        }
    }
};

Scene scene_of(const TriangleMesh& triangles, std::initializer_list<Transform> places) {
    Scene scene;
    scene.bakes_small_meshes = false;
    Mesh mesh;
    mesh.positions = triangles.positions;
    mesh.indices = triangles.indices;
    scene.meshes.push_back(mesh);
    scene.materials.push_back({});
    for (const Transform& place : places) scene.instances.push_back({"sphere", 0, 0, place});
    return scene;
}

} // namespace

// Both tests together trace 3 * 2 * (1,100,000 + 300,000 + 2 * 150,000) = 10.2 million rays, and ten times as many in
// the long setting.

TEST_CASE("no ray leaves a closed sphere") {
    uint32_t set_number = 0;
    for (const float away_m : {0.0f, 1e3f, 1.5e5f}) {
        CAPTURE(away_m);
        const Vec3 centre = {away_m, 0, -1.5f * away_m};
        // At 150 km floats are 1/64 m apart, so smaller faces would overlap.
        const TriangleMesh sphere = make_sphere(away_m > 1e4f ? 2 : 5, centre, 1);
        ClosedInstance instance(scene_of(sphere, {{}}), sphere, centre);
        REQUIRE(instance.prepared.tlas.root == kNoLink); // baked
        // Binary nodes take three times as long per ray on a CPU. Their triangle test is that of wide nodes.
        const uint64_t count = effort(600'000, 7'000'000), count_of_binary = effort(150'000, 7'000'000);
        instance.check_tracer(default_tracers(instance.queue.is_cuda()).bounce, count, ++set_number);
        instance.check_tracer(kBinaryTracer, count_of_binary, ++set_number);
    }
}

TEST_CASE("no ray leaves a closed sphere that is an instance") {
    uint32_t set_number = 100;
    for (const float away_m : {0.0f, 1e3f, 1.5e5f}) {
        CAPTURE(away_m);
        const Vec3 centre = {away_m, 0, -1.5f * away_m};
        const TriangleMesh local = make_sphere(4, {3, 4, 5}, 2);
        const Transform place = compose(
            make_translation(centre), compose(make_rotation(0.48f, 0.6f, 0, 0.64f), // unit
                                              compose(make_scale({0.5f, 0.5f, 0.5f}), make_translation({-3, -4, -5}))));
        TriangleMesh world = local;
        for (Vec3& v : world.positions) v = transform_point(place, v);
        // The second instance prevents baking.
        ClosedInstance instance(scene_of(local, {place, compose(make_translation({0, 20, 0}), place)}), world, centre);
        REQUIRE(instance.prepared.tlas.root != kNoLink);
        const uint64_t count = effort(150'000, 1'500'000);
        instance.check_tracer(default_tracers(instance.queue.is_cuda()).bounce, count, ++set_number);
        instance.check_tracer(kBinaryTracer, count, ++set_number);
    }
}
