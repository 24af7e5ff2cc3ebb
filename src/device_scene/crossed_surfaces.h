#pragma once

// Surfaces that a ray crosses straight: the clear boundaries of media, which tracers do not hit, and the thin walls
// that shadow rays pass (thin_walls.h). A ray meets many on its way to a surface or a light, so each of the two kinds
// has a tree of its own, in the translated world, in which device code finds crossings in order.

#include <cstdint>
#include <vector>

#include "accel/bvh/bvh.h"
#include "base/host_device.h"
#include "math/vec3.h"

namespace pertev {

struct PlacedScene;

/// A triangle of such a surface, by its number, which is BvhTriangle::primitive.
struct CrossedTriangle {
    Vec3 normal; // front_normal(), of any length
    uint32_t instance, primitive;
};

struct CrossedSurfacesView {
    BvhView tree;
    const CrossedTriangle* triangles = nullptr; // null: there are none

    HD bool is_there() const { return triangles != nullptr; }
};

/// Crossed surfaces of a scene on the host.
struct CrossedSurfaces {
    Bvh tree;
    std::vector<CrossedTriangle> triangles;
};

/// Returns the clear boundaries of media. Instances that move while a shutter is open, and vertices that a pose moves,
/// count where they are at rest.
CrossedSurfaces find_medium_boundaries(const PlacedScene& placed);

/// Most triangles of thin walls that shadow rays pass. A scene with more has walls that block them.
inline constexpr std::size_t kMaxThinWallTriangles = std::size_t{1} << 20;

/// Returns, by instance, which ones are thin walls that shadow rays pass: opaque to alpha, not emitting, with light
/// that goes straight through, and always at rest. Empty: none.
std::vector<bool> find_thin_walls(const PlacedScene& placed);
/// Returns the surfaces of the instances that find_thin_walls() lists.
CrossedSurfaces surfaces_of_thin_walls(const PlacedScene& placed, const std::vector<bool>& is_thin_wall);

} // namespace pertev
