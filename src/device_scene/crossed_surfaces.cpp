#include "device_scene/crossed_surfaces.h"

#include "accel/builders/build_bvh.h"
#include "device_scene/placed_scene.h"
#include "math/transform.h"
#include "shading/may_be_specular.h"

namespace pertev {
namespace {

/// Makes the tree over all instances i that `is_crossed(i)` selects.
template <class IsCrossed>
CrossedSurfaces collect(const PlacedScene& placed, const IsCrossed& is_crossed) {
    const Scene& scene = *placed.scene;
    CrossedSurfaces found;
    std::vector<BvhTriangle> triangles;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        if (instance.is_hidden || instance.is_background || !is_crossed(i)) continue;
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
            found.triangles.push_back({normal, static_cast<uint32_t>(i), static_cast<uint32_t>(k / 3)});
        }
    }
    if (!triangles.empty()) found.tree = build_bvh(triangles);
    return found;
}

} // namespace

CrossedSurfaces find_medium_boundaries(const PlacedScene& placed) {
    const Scene& scene = *placed.scene;
    if (!has_media(scene)) return {};
    return collect(placed,
                   [&](std::size_t i) { return scene.materials[scene.instances[i].material].is_clear_boundary; });
}

std::vector<bool> find_thin_walls(const PlacedScene& placed) {
    const Scene& scene = *placed.scene;
    std::vector<bool> may_deform(scene.meshes.size());
    for (std::size_t i = 0; i < placed.poses.size(); ++i) may_deform[scene.shapes[i].mesh] = true;
    std::vector<bool> found(scene.instances.size());
    std::size_t triangles = 0;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Material& material = scene.materials[instance.material];
        const bool moves = placed.motions != nullptr && placed.motions->of_instance[i] != kNoMotion;
        found[i] = may_pass_straight(material) && material.alpha_mode == AlphaMode::Opaque && !material.is_emitter() &&
                   !instance.is_hidden && !instance.is_background && !may_deform[instance.mesh] && !moves;
        if (found[i]) triangles += scene.meshes[instance.mesh].triangle_count();
    }
    if (triangles == 0 || triangles > kMaxThinWallTriangles) return {};
    return found;
}

CrossedSurfaces surfaces_of_thin_walls(const PlacedScene& placed, const std::vector<bool>& is_thin_wall) {
    if (is_thin_wall.empty()) return {};
    return collect(placed, [&](std::size_t i) { return is_thin_wall[i]; });
}

} // namespace pertev
