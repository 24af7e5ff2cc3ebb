#pragma once

// The box and triangle tests of a traversal, as one choice. Rendering uses ExactTests: conservative boxes, watertight
// triangles, equal bits everywhere. FastTests is only for the laboratory, which measures the cost of exactness: most
// tracers use such tests, and rays at edges slip through them.
//
// Source of the fast triangle test: Moeller, Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", 1997.

#include "base/host_device.h"
#include "trace/intersect/intersect_triangle.h"
#include "trace/intersect/ray.h"
#include "trace/intersect/ray_boxes.h"

namespace pertev {

struct ExactTests {
    using Boxes = RayBoxes;
    using Triangles = RayShear; // computed once per ray

    HD static Boxes make_boxes(const Ray& ray, float bounds_max_abs) {
        return make_ray_boxes(ray.origin, ray.direction, bounds_max_abs);
    }
    HD static float box_growth(const Ray& ray, float bounds_max_abs) {
        return pertev::box_growth(ray.origin, bounds_max_abs);
    }
    HD static Triangles make_triangles(const Ray& ray) { return make_ray_shear(ray.direction); }
    HD static bool intersect(const Ray& ray, const Triangles& shear, Vec3 a, Vec3 b, Vec3 c, TriangleHit& hit) {
        return intersect_triangle(ray.origin, shear, ray.t_min, ray.t_max, a, b, c, hit);
    }
};

/// 1 / x with an error of about one unit in the last place on the device, where denormal numbers are 0.
HD inline float fast_reciprocal(float x) {
#if PERTEV_ON_DEVICE && !defined(PERTEV_EMULATED_WARPS)
    float r;
    asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(r) : "f"(x));
    return r;
#else
    return 1.0f / x;
#endif
}

struct FastTests {
    using Boxes = RayBoxes; // with growth 0, so that lo and hi are equal, which the compiler uses
    struct Triangles {};

    HD static Boxes make_boxes(const Ray& ray, float) {
        Boxes r;
        r.inv = {fast_reciprocal(guard_direction(ray.direction.x)), fast_reciprocal(guard_direction(ray.direction.y)),
                 fast_reciprocal(guard_direction(ray.direction.z))};
        r.lo = {-(ray.origin.x * r.inv.x), -(ray.origin.y * r.inv.y), -(ray.origin.z * r.inv.z)};
        r.hi = r.lo;
        return r;
    }
    /// Growth of boxes that are tested against a segment (ray_segment.h), metres. Without growth, flat ones would be
    /// missed.
    HD static float box_growth(const Ray& ray, float bounds_max_abs) {
        return pertev::box_growth(ray.origin, bounds_max_abs);
    }
    HD static Triangles make_triangles(const Ray&) { return {}; }
    HD static bool intersect(const Ray& ray, Triangles, Vec3 a, Vec3 b, Vec3 c, TriangleHit& hit) {
        const auto dot_fma = [](Vec3 p, Vec3 q) { return fma(p.x, q.x, fma(p.y, q.y, p.z * q.z)); };
        const auto cross_fma = [](Vec3 p, Vec3 q) {
            return Vec3{fma(p.y, q.z, -(p.z * q.y)), fma(p.z, q.x, -(p.x * q.z)), fma(p.x, q.y, -(p.y * q.x))};
        };
        const Vec3 ab = b - a, ac = c - a, p = cross_fma(ray.direction, ac);
        const float inv = fast_reciprocal(dot_fma(ab, p));
        const Vec3 from = ray.origin - a, q = cross_fma(from, ab);
        const float u = dot_fma(from, p) * inv, v = dot_fma(ray.direction, q) * inv, t = dot_fma(ac, q) * inv;
        if (!(u >= 0 && v >= 0 && u + v <= 1 && t > ray.t_min && t < ray.t_max)) return false;
        hit = {t, u, v};
        return true;
    }
};

} // namespace pertev
