#pragma once

// A binary tree that also stores each triangle as the affine transform to the unit triangle (0,0,0) (1,0,0) (0,1,0),
// in whose space three dot products test a ray. It is for the laboratory, because the kernels of Aila and Laine use
// it. Far from the origin it loses more rays than a test of the vertices.
//
// Source: Woop, "A Ray Tracing Hardware Architecture for Dynamic Scenes", M.Sc. thesis, Saarland University, 2004,
// section 4.2. It is not the watertight test of Woop, Benthin and Wald.

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "base/sink.h"
#include "math/vec3.h"

namespace pertev {

/// Three rows of the transform: at point p the height over the plane, u and v are `row . p + shift`. It has 48 bytes,
/// loaded as three times 16. The height's row has length 1. Triangles without area, or too small or too large, have u
/// = -1 everywhere and are never hit.
struct alignas(16) WoopTriangle {
    Vec3 normal; // the lowest bit of its x is kLastInLeaf
    float height = 0;
    Vec3 u_row;
    float u_shift = 0;
    Vec3 v_row;
    float v_shift = 0;
};
static_assert(sizeof(WoopTriangle) == 48);

/// Makes the transform; u belongs to vertex b and v to vertex c. `last` sets kLastInLeaf.
WoopTriangle make_woop_triangle(Vec3 a, Vec3 b, Vec3 c, bool last);

struct WoopBvh : Bvh {
    std::vector<WoopTriangle> transforms; // [triangles.size()], in the order of the triangles
};

/// Arrays of a WoopBvh for traversal. Of `triangles` it reads only the ids of those that are hit.
struct WoopBvhView : BvhView {
    const WoopTriangle* transforms = nullptr;
};

/// Makes a WoopBvh of a tree by adding the transforms. The result does not depend on the number of threads.
/// `sink` may end it.
WoopBvh make_woop_bvh(const Bvh& bvh, Sink& sink = nobody());

WoopBvhView view_of(const WoopBvh& bvh);

} // namespace pertev
