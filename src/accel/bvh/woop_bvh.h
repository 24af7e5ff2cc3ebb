#pragma once

// A binary tree whose triangles are stored a second time, as the affine transforms that take each to the unit triangle
// (0,0,0) (1,0,0) (0,1,0): in its space a ray is tested by three dot products. For the laboratory, since that is what
// the kernels of Aila and Laine do; far from the origin it loses rays, more than a test of the corners does.
//
// Source: Woop, "A Ray Tracing Hardware Architecture for Dynamic Scenes", M.Sc. thesis, Saarland University, 2004,
// section 4.2. It is not the watertight test of Woop, Benthin and Wald.

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "math/vec3.h"

namespace pertev {

/// Three rows of the transform: at point p the height over the plane, u and v are `row . p + shift`. 48 bytes, three
/// loads of 16. The height's row has the length 1. Triangles without area, or too small or large for it, have u = -1
/// everywhere: they are never hit.
struct alignas(16) WoopTriangle {
    Vec3 normal; // the lowest bit of its x is kLastInLeaf
    float height = 0;
    Vec3 u_row;
    float u_shift = 0;
    Vec3 v_row;
    float v_shift = 0;
};
static_assert(sizeof(WoopTriangle) == 48);

/// `last`: kLastInLeaf. u belongs to corner b, v to c.
WoopTriangle make_woop_triangle(Vec3 a, Vec3 b, Vec3 c, bool last);

struct WoopBvh : Bvh {
    std::vector<WoopTriangle> transforms; // [triangles.size()], in their order
};

/// What a walk needs. Of `triangles` it reads which they are, of those alone that are hit.
struct WoopBvhView : BvhView {
    const WoopTriangle* transforms = nullptr;
};

/// The same for any number of threads.
WoopBvh make_woop_bvh(const Bvh& bvh);

WoopBvhView view_of(const WoopBvh& bvh);

} // namespace pertev
