#pragma once

// The laboratory's oracle: tests each ray against every triangle of the scene as it was read, without any tree. It
// applies the result rule of docs/conventions.md literally, with the triangle test that the traversals use. It shares
// nothing else with them. (trace/brute_force_traversal.h tests all triangles of a tree within the traversal code and is
// itself checked against this.)

#include <cstdint>
#include <span>
#include <vector>

#include "base/host_device.h"
#include "device/buffer.h"
#include "device/launch.h"
#include "lab/in_pieces.h"
#include "lab/trace_rays.h"
#include "render/prepare_scene.h"

namespace pertev {

struct TriangleRange {
    const BvhTriangle* first = nullptr;
    uint64_t count = 0;
};

struct BruteForceRays {
    TriangleRange baked;
    const TriangleRange* meshes; // indexed by InstanceRecord::blas
    const InstanceRecord* instances;
    uint64_t instance_count;
    const Ray* rays;
    RayHit* hits; // the closest ones

    HD void operator()(uint32_t i) const {
        const Ray ray = load_ray(rays + i);
        RayHit best = {ray.t_max, kNoHit, 0};
        test(baked, ray, kNoHit, best);
        for (uint64_t k = 0; k < instance_count; ++k) {
            const InstanceRecord record = load_aligned(instances + k);
            test(meshes[record.blas], transform_ray(record.local_from_world, ray), record.instance, best);
        }
        hits[i] = best;
    }

private:
    /// Returns whether the triangle, seen along the ray, lies entirely to one side of it. The exact edge signs then
    /// differ, so the triangle test would refuse it. This check takes a sixth of the work.
    HD static bool is_beside(const BvhTriangle& t, Vec3 origin, const RayShear& ray) {
        const Vec3 a = shear(t.a - origin, ray), b = shear(t.b - origin, ray), c = shear(t.c - origin, ray);
        return (a.x > 0 && b.x > 0 && c.x > 0) || (a.x < 0 && b.x < 0 && c.x < 0) || (a.y > 0 && b.y > 0 && c.y > 0) ||
               (a.y < 0 && b.y < 0 && c.y < 0);
    }

    HD static void test(const TriangleRange& triangles, const Ray& ray, uint32_t instance, RayHit& best) {
        const RayShear shear = make_ray_shear(ray.direction);
        for (uint64_t k = 0; k < triangles.count; ++k) {
            const BvhTriangle t = load_aligned(triangles.first + k);
            if (is_beside(t, ray.origin, shear)) continue;
            TriangleHit hit;
            if (!intersect_triangle(ray.origin, shear, ray.t_min, ray.t_max, t.a, t.b, t.c, hit)) continue;
            const uint32_t id = instance == kNoHit ? t.instance : instance;
            const bool first =
                hit.t < best.t ||
                (hit.t == best.t && (id < best.instance || (id == best.instance && t.primitive < best.primitive)));
            if (first) best = {hit.t, id, t.primitive};
        }
    }
};

/// Holds the triangles in a device's memory and tests any number of rays against them.
class BruteForce {
public:
    BruteForce(Queue& queue, const SceneTriangles& triangles, const Tlas& tlas);
    std::vector<RayHit> trace(std::span<const Ray> rays, const PieceDone& done) const;

private:
    Queue& queue_;
    std::vector<Buffer<BvhTriangle>> triangles_;
    Buffer<TriangleRange> meshes_;
    Buffer<InstanceRecord> instances_;
};

} // namespace pertev
