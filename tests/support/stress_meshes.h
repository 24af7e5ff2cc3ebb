#pragma once

// Meshes and rays that are difficult for structures and traversals: ties, slivers, flat boxes, huge coordinates, rays
// along planes.

#include <cstdint>
#include <string>
#include <vector>

#include "accel/bvh/bvh.h"
#include "tests/support/meshes.h"
#include "trace/intersect/ray.h"

namespace pertev::test {

struct StressMesh {
    const char* name;
    std::vector<BvhTriangle> triangles; // (instance, primitive) pairs are unique unless the name says otherwise
    Vec3 centre;
    float extent = 1; // in metres; rays start within 4 extents of the centre
};

/// Returns triangles of random sizes around (away, 0, -away), some without area.
std::vector<BvhTriangle> make_soup(uint32_t count, float away);

/// Returns a lattice of doubled quads, coincident triangles, long slivers, soups at the origin and 150 km away, huge
/// coordinates, `line` triangles in a line, a torus, one triangle, and an empty mesh.
std::vector<StressMesh> stress_meshes(uint32_t line = 3000);

/// Returns random rays, rays at vertices, along edges, axes and planes of boxes, through lattice points, with
/// components near 0, and with short t ranges.
std::vector<Ray> stress_rays(uint32_t count, const StressMesh& mesh, uint32_t seed);

/// Returns a ray as hex floats.
std::string text_of(const Ray& ray);

} // namespace pertev::test
