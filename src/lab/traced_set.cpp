#include "lab/traced_set.h"

#include <algorithm>
#include <atomic>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel_for.h"
#include "lab/measure_rays.h"
#include "math/transform.h"

namespace pertev {
namespace {

/// Returns a random triangle of the scene, in world space.
BvhTriangle some_triangle(const LabTriangles& triangles, uint32_t& state) {
    const auto below = [&](std::size_t count) {
        return std::min(static_cast<std::size_t>(draw(state) * static_cast<float>(count)), count - 1);
    };
    const auto& instances = triangles.tlas.instances;
    const bool baked = instances.empty() || (!triangles.parts.baked.empty() && draw(state) < 0.5f);
    if (baked) return triangles.parts.baked[below(triangles.parts.baked.size())];
    const InstanceRecord& record = instances[below(instances.size())];
    const Transform world_from_local = inverse(record.local_from_world);
    BvhTriangle t = triangles.parts.meshes[record.blas][below(triangles.parts.meshes[record.blas].size())];
    t.a = transform_point(world_from_local, t.a);
    t.b = transform_point(world_from_local, t.b);
    t.c = transform_point(world_from_local, t.c);
    return t;
}

Ray stress_ray(Ray ray, uint32_t i, const LabTriangles& triangles) {
    uint32_t state = secondary_state(i, 99);
    const BvhTriangle t = some_triangle(triangles, state);
    switch (i % 4) {
    case 0: { // along an axis; the other components are exactly 0, with either sign
        const float sign = i & 4 ? -1.0f : 1.0f, zero = i & 8 ? -0.0f : 0.0f;
        const uint32_t axis = i / 16 % 3;
        ray.direction = {axis == 0 ? sign : zero, axis == 1 ? sign : zero, axis == 2 ? sign : zero};
        break;
    }
    case 1:
        ray.direction = t.b - ray.origin;
        break; // through a vertex
    case 2:
        ray.direction = 0.5f * (t.a + t.c) - ray.origin;
        break; // through an edge
    case 3:
        ray.direction = t.b - t.a, ray.origin = t.a - ray.direction;
        break; // along an edge
    }
    const float size = max_component(abs(ray.direction));
    if (!(size >= 0x1p-40f && size <= 0x1p40f)) ray.direction = {0, 0, 1};
    return ray;
}

RayHit wanted_of(const RayHit& hit, bool any_hit) {
    return any_hit ? RayHit{0.0f, hit.is_hit() ? 0u : kNoHit, 0u} : hit;
}

std::string text_of(const Ray& r) {
    return fmt::format("origin {:a} {:a} {:a} direction {:a} {:a} {:a} t {:a} {:a}", r.origin.x, r.origin.y, r.origin.z,
                       r.direction.x, r.direction.y, r.direction.z, r.t_min, r.t_max);
}

bool differs(const RayHit& a, const RayHit& b, bool exact) {
    return exact ? !(a == b) : a.instance != b.instance || (a.is_hit() && a.primitive != b.primitive);
}

std::vector<RayHit> trace_reference(Queue& queue, const Tracer& reference, bool any_hit, const Buffer<Ray>& rays,
                                    const PieceDone& done) {
    const HitsOnDevice hits(queue, rays.size());
    const auto trace_piece = [&](uint64_t begin, uint64_t count) {
        trace(reference, any_hit, rays.data() + begin, static_cast<uint32_t>(count), hits.from(begin));
        queue.wait();
    };
    in_pieces(rays.size(), first_piece_of_rays(), trace_piece, done);
    return hits.download(any_hit);
}

} // namespace

std::vector<Ray> oracle_rays(const RaySet& set, const LabTriangles& triangles, uint32_t count, uint32_t stress_count) {
    std::vector<Ray> rays;
    const std::size_t of_set = std::min<std::size_t>(count, set.rays.size());
    for (std::size_t i = 0; i < of_set; ++i) rays.push_back(set.rays[i * set.rays.size() / of_set]);
    if (of_set == 0) return rays;
    for (uint32_t i = 0; i < stress_count; ++i) rays.push_back(stress_ray(rays[i % of_set], i, triangles));
    return rays;
}

uint64_t check_reference_traversal(Queue& queue, const RaySet& set, const Tracer& reference, const BruteForce& oracle,
                                   const LabTriangles& triangles, uint32_t count, uint32_t stress_count,
                                   const PieceDone& done) {
    const std::vector<Ray> some = oracle_rays(set, triangles, count, stress_count);
    const std::vector<RayHit> truth = oracle.trace(some, done);
    const std::vector<RayHit> found =
        trace_reference(queue, reference, set.any_hit, Buffer<Ray>(queue, std::span<const Ray>(some), "rays"), {});
    for (std::size_t i = 0; i < some.size(); ++i) {
        if (found[i] == wanted_of(truth[i], set.any_hit)) continue;
        throw Error(
            ErrorCode::DeviceFault,
            fmt::format("the reference traversal differs from brute force on {} ({}): instance {} instead of {}, "
                        "primitive {} instead of {}, t {:a} instead of {:a}; please report it",
                        set.name, text_of(some[i]), found[i].instance, truth[i].instance, found[i].primitive,
                        truth[i].primitive, found[i].t, truth[i].t));
    }
    return some.size();
}

TracedSet trace_set(Queue& queue, const RaySet& set, const Tracer& reference, const PieceDone& done) {
    TracedSet traced;
    traced.rays = Buffer<Ray>(queue, std::span<const Ray>(set.rays), set.name + " rays");
    traced.wanted = trace_reference(queue, reference, set.any_hit, traced.rays, done);
    traced.figures = {.name = set.name, .any_hit = set.any_hit, .rays = set.rays.size()};
    traced.figures.hit_share = hit_share(traced.wanted);
    return traced;
}

uint64_t count_different(std::span<const RayHit> hits, std::span<const RayHit> wanted, bool exact) {
    PERTEV_CHECK(hits.size() == wanted.size());
    std::atomic<uint64_t> different{0};
    parallel_for_ranges(hits.size(), 1 << 14, [&](uint64_t begin, uint64_t end) {
        uint64_t here = 0;
        for (uint64_t i = begin; i < end; ++i) here += differs(hits[i], wanted[i], exact) ? 1 : 0;
        different += here;
    });
    return different;
}

} // namespace pertev
