#pragma once

// Tests several rays with the same dominant axis against all triangles of a list, host only: eight or, on processors
// with AVX-512, sixteen rays at a time.

#include <array>
#include <cstdint>

#include "accel/bvh/bvh.h"
#include "base/processor.h"
#include "trace/intersect/ray.h"

namespace pertev {

inline constexpr uint32_t kNoTriangle = 0xffffffffu;

/// The nearest triangle of each ray, or any if that will do.
struct NearestTriangles {
    alignas(64) float t[kMaxLanes], u[kMaxLanes], v[kMaxLanes];
    alignas(64) uint32_t triangle[kMaxLanes]; // number in the list; kNoTriangle: there is none
    unsigned alone = 0; // one bit for each ray that must be tested by itself: a triangle needs the slow test, or two
                        // lie at the same distance
};

struct TriangleList {
    const BvhTriangle* triangles;
    uint32_t count;
};

/// A function that finds the nearest triangles of rays, and the number of rays that it takes at a time.
struct TriangleTests {
    uint32_t lanes;
    /// Tests the triangles of `list`. `rays` are `lanes` rays whose directions have their largest component along axis
    /// `kz`; `active` has one bit for each ray that is to be tested. `any` says that any triangle will do.
    void (*find)(const TriangleList& list, const Ray* rays, int kz, unsigned active, bool any,
                 NearestTriangles& nearest);
};

extern const TriangleTests kTestsOf8Rays;
#if defined(PERTEV_HAS_16_LANES)
extern const TriangleTests kTestsOf16Rays;
#endif

/// The widest that this computer's processor has.
const TriangleTests& triangle_tests();

} // namespace pertev
