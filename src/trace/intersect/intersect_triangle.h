#pragma once

// Watertight ray-triangle test: on a closed mesh no ray slips between two triangles or through a vertex, wherever the
// mesh lies, and a hit never lies outside its triangle, however thin or edge-on that is.
//
// Source: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013, section 3; edge functions by
// Kahan's difference of products (Jeannerod, Louvet, Muller 2013: at most 1.5 ulp off).
// Why it cannot leak: each edge function has its exact sign, and the two neighbours of an edge see opposite signs or
// both see zero. That needs the same sheared vertices in both: the build turns contraction off.

#include "base/host_device.h"
#include "math/difference_of_products.h"
#include "math/vec3.h"
#include "trace/intersect/fast_min_max.h"

namespace pertev {

struct RayShear {     // depends on the ray alone: once per ray and object space
    int kx, ky, kz;   // permutation of {0, 1, 2}; kz is the largest component of the direction
    float sx, sy, sz; // shear that sends the direction to (0, 0, 1); no unit
};

struct TriangleHit {
    float t;    // distance along the ray, in multiples of its direction's length
    float u, v; // weights of the second and third vertex: u, v >= 0, u + v <= 1 up to 2 ulp
};

/// Returns x / z to the bit; |x| <= |z|, |z| within [2^-40, 2^40]; `inv` is reciprocal_of_normal(z). On the device it
/// uses the compiler's instructions for a division, but without their slow path for 0, which all axis-aligned rays
/// would take.
HD inline float slope(float x, float z, [[maybe_unused]] float inv) {
#if PERTEV_ON_DEVICE && !defined(PERTEV_EMULATED_WARPS)
    if (abs(x) < 0x1p-60f && x != 0) return x / z; // floats might not hold the remainder
    const float quotient = x * inv;
    const float corrected = ::fmaf(inv, ::fmaf(-z, quotient, x), quotient);
    return x == 0 ? quotient : corrected; // zero with the right sign
#else
    return x / z;
#endif
}

/// Shear of a ray. `direction` is finite; its largest component is within [2^-40, 2^40].
HD inline RayShear make_ray_shear(Vec3 direction) {
    const Vec3 size = abs(direction);
    const int kz = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    const int kx = kz == 2 ? 0 : kz + 1, ky = kz == 0 ? 2 : kz - 1;
    const float dz = component(direction, kz);
    const float sz = reciprocal_of_normal(dz);
    return {kx, ky, kz, slope(component(direction, kx), dz, sz), slope(component(direction, ky), dz, sz), sz};
}

/// Shears `p`, relative to the ray's origin, so that the direction becomes +z. Every caller gets the same rounding.
HD inline Vec3 shear(Vec3 p, const RayShear& ray) {
    // The three cyclic orders by two selects per component.
    const bool to_x = ray.kz == 0, to_y = ray.kz == 1;
    const float x = to_x ? p.y : (to_y ? p.z : p.x);
    const float y = to_x ? p.z : (to_y ? p.x : p.y);
    const float z = to_x ? p.x : (to_y ? p.y : p.z);
    return {fma(-ray.sx, z, x), fma(-ray.sy, z, y), z};
}

inline constexpr float kSureEdge = 0x1p-100f; // an edge function of this size or more has its exact sign

/// Finds a hit on the front or back face with t_min < t < t_max. Returns false if there is none; `hit` is written on
/// true only. A triangle without area, or with a vertex that is not finite, is never hit.
HD inline bool intersect_triangle(Vec3 origin, const RayShear& ray, float t_min, float t_max, Vec3 a, Vec3 b, Vec3 c,
                                  TriangleHit& hit) {
    const Vec3 pa = shear(a - origin, ray), pb = shear(b - origin, ray), pc = shear(c - origin, ray);

    float ea = difference_of_products(pc.x, pb.y, pc.y, pb.x);
    float eb = difference_of_products(pa.x, pc.y, pa.y, pc.x);
    float ec = difference_of_products(pb.x, pa.y, pb.y, pa.x);
    // If an edge function is NaN, the triangle is not hit, whatever the result here. Two edge functions with surely
    // different signs mean a miss, whatever the third is, for example zero for an edge along the ray, which
    // axis-aligned rays meet at every other wall.
    const float below = fast_min(ea, fast_min(eb, ec)), above = fast_max(ea, fast_max(eb, ec));
    if (fast_min(-below, above) >= kSureEdge) return false;
    if (fast_min(abs(ea), fast_min(abs(eb), abs(ec))) < kSureEdge) {
        // It is zero, or products may have underflowed: the exact values in double. Only their ratios matter below,
        // so they are scaled into the range of floats; one that still vanishes beside the others counts as zero,
        // which is inside.
        const double da = difference_of_products_in_double(pc.x, pb.y, pc.y, pb.x);
        const double db = difference_of_products_in_double(pa.x, pc.y, pa.y, pc.x);
        const double dc = difference_of_products_in_double(pb.x, pa.y, pb.y, pa.x);
        const double scale = 1 / ((da < 0 ? -da : da) + (db < 0 ? -db : db) + (dc < 0 ? -dc : dc));
        ea = static_cast<float>(da * scale), eb = static_cast<float>(db * scale), ec = static_cast<float>(dc * scale);
        // Zero counts as inside for both neighbours, so an edge may be hit twice but never missed.
        if ((ea < 0 || eb < 0 || ec < 0) && (ea > 0 || eb > 0 || ec > 0)) return false;
    }
    const float det = ea + eb + ec;
    if (det == 0) return false;
    // Either three numbers of one sign, each at least 2^-100, or numbers whose sizes add up to 1. It is below 2^126
    // because it is twice the area of a triangle in the scene. (If products overflow it is infinite or NaN, which is
    // a miss.)
    const float inv = reciprocal_of_normal(det), u = eb * inv, v = ec * inv;
    const float t = (ea * inv * pa.z + u * pb.z + v * pc.z) * ray.sz;
    if (!(t > t_min && t < t_max)) return false; // so written that NaN (bad vertex) is a miss
    hit = {t, u, v};
    return true;
}

} // namespace pertev
