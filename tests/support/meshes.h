#pragma once

// Meshes made by the tests themselves, and the plainest possible ray caster to hold the traversals against.

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "accel/bvh/bvh.h"
#include "tests/support/random.h"
#include "trace/intersect/intersect_triangle.h"
#include "trace/intersect/ray.h"

namespace pertev::test {

struct TriangleMesh {
    std::vector<Vec3> positions;
    std::vector<uint32_t> indices;

    uint32_t triangle_count() const { return static_cast<uint32_t>(indices.size() / 3); }
    Vec3 corner(uint32_t triangle, int k) const { return positions[indices[3 * triangle + static_cast<uint32_t>(k)]]; }
};

/// Icosahedron, each face cut in four `subdivisions` times, vertices on the sphere. Closed.
TriangleMesh make_sphere(int subdivisions, Vec3 centre_m, float radius_m);
/// Bumpy closed torus of 2 * segments * sides triangles of very uneven sizes.
TriangleMesh make_torus(int segments, int sides);
/// Reads only the vertices and faces of an OBJ file; polygons become fans.
TriangleMesh read_obj_geometry(const std::filesystem::path& path);

/// Triangles for builders; primitive ids in the mesh's order.
std::vector<BvhTriangle> triangles_of(const TriangleMesh& mesh, uint32_t instance = 0);

/// Tests every triangle by the result rule of docs/conventions.md, and stores a better hit in `best`.
template <class Accept>
void trace_by_brute_force(std::span<const BvhTriangle> triangles, const Ray& ray, uint32_t instance,
                          const Accept& accept, Hit& best) {
    const RayShear shear = make_ray_shear(ray.direction);
    for (const BvhTriangle& t : triangles) {
        TriangleHit hit;
        if (!intersect_triangle(ray.origin, shear, ray.t_min, ray.t_max, t.a, t.b, t.c, hit)) continue;
        const uint32_t id = instance == kNoHit ? t.instance : instance;
        if (!accept(id, t.primitive, hit.u, hit.v)) continue;
        const bool first =
            best.instance == kNoHit || hit.t < best.t ||
            (hit.t == best.t && (id < best.instance || (id == best.instance && t.primitive < best.primitive)));
        if (first) best = {hit.t, hit.u, hit.v, id, t.primitive};
    }
}

} // namespace pertev::test
