#pragma once

// The clear boundaries of media, which tracers do not hit: light passes them unchanged, so that a ray meets many on its
// way to a surface or a light. They have a tree of their own, in the translated world, in which device code finds the
// boundaries along a ray in order. Instances that move while a shutter is open, and vertices that a pose moves, count
// where they are at rest.

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "math/vec3.h"

namespace pertev {

struct PlacedScene;

/// A triangle of a boundary, by its number, which is BvhTriangle::primitive.
struct BoundaryTriangle {
    Vec3 normal; // front_normal(), of any length
    uint32_t instance;
};

struct MediumBoundariesView {
    BvhView tree;
    const BoundaryTriangle* triangles = nullptr; // null: there are none

    HD bool is_there() const { return triangles != nullptr; }
};

/// The boundaries of a scene on the host.
struct MediumBoundaries {
    Bvh tree;
    std::vector<BoundaryTriangle> triangles;
};
MediumBoundaries find_medium_boundaries(const PlacedScene& placed);

} // namespace pertev
