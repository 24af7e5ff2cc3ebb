#include "device_scene/medium_boundaries.h"

#include "accel/builders/build_bvh.h"
#include "device_scene/placed_scene.h"
#include "math/transform.h"

namespace pertev {

MediumBoundaries find_medium_boundaries(const PlacedScene& placed) {
    const Scene& scene = *placed.scene;
    MediumBoundaries found;
    if (!has_media(scene)) return found;
    std::vector<BvhTriangle> triangles;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const bool is_boundary = scene.materials[instance.material].is_clear_boundary;
        if (instance.is_hidden || instance.is_background || !is_boundary) continue;
        const Transform world_from_local = moved_to(instance.world_from_local, placed.centre);
        const Transform local_from_world = inverse(world_from_local);
        const Mesh& mesh = scene.meshes[instance.mesh];
        for (std::size_t k = 0; k < mesh.indices.size(); k += 3) {
            const uint32_t* const at = mesh.indices.data() + k;
            const auto corner = [&](int n) { return transform_point(world_from_local, mesh.positions[at[n]]); };
            const Vec3 a = corner(0), ab = corner(1) - a, ac = corner(2) - a;
            const float size = max(max_component(abs(ab)), max_component(abs(ac)));
            const float scale = size > 0 ? 1.0f / size : 0.0f;
            Vec3 normal = cross(scale * ab, scale * ac);
            if (is_mirroring(instance.world_from_local)) normal = -normal;
            if (!mesh.normals.empty()) {
                const Vec3 sum = mesh.normals[at[0]] + mesh.normals[at[1]] + mesh.normals[at[2]];
                if (dot(transform_transposed(local_from_world, sum), normal) < 0) normal = -normal;
            }
            const auto number = static_cast<uint32_t>(found.triangles.size());
            triangles.push_back({a, number, corner(1), 0, corner(2), 0});
            found.triangles.push_back({normal, static_cast<uint32_t>(i)});
        }
    }
    if (!triangles.empty()) found.tree = build_bvh(triangles);
    return found;
}

} // namespace pertev
