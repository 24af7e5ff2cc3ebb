#include "scene/scene.h"

#include <algorithm>

#include "base/limits.h"
#include "scene/position_bounds.h"

namespace pertev {
namespace {

Vec3 corner_of(const Bounds3& box, int number) {
    return {number & 1 ? box.hi.x : box.lo.x, number & 2 ? box.hi.y : box.lo.y, number & 4 ? box.hi.z : box.lo.z};
}

} // namespace

Transform placed_in(const NodeTransform& transform, const Transform& node_from_local, DoubleVec3 origin) {
    if (node_from_local == Transform()) return world_from_node(transform, origin);
    Transform world = compose(transform.linear, node_from_local);
    const DoubleVec3 at = transform_point(transform.world_from_node, to_double(node_from_local.translation));
    world.translation = to_float(at - origin);
    return world;
}

std::string origin_of(const Instance& instance) {
    return instance.node == kNoNode ? "" : "/nodes/" + std::to_string(instance.node);
}

Bounds3 bounds_of(const Mesh& mesh) {
    if (mesh.indices.size() >= 1 << 16) return bounds_of(mesh.positions, mesh.indices);
    Bounds3 bounds;
    for (const uint32_t index : mesh.indices) bounds.extend(mesh.positions[index]);
    return bounds;
}

bool is_within_limits(const Transform& world_from_local, const Bounds3& local) {
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p = transform_point(world_from_local, corner_of(local, corner));
        if (!(is_finite(p) && max_component(abs(p)) <= kMaxCoordinate)) return false;
    }
    return true;
}

bool has_media(const Scene& scene) {
    if (scene.medium.is_there()) return true;
    return std::ranges::any_of(scene.instances, [&](const Instance& instance) {
        const Material& material = scene.materials[instance.material];
        return !instance.is_hidden && material.medium.is_there() && material.encloses();
    });
}

Bounds3 bounds_of(const Scene& scene) {
    std::vector<Bounds3> of_mesh(scene.meshes.size());
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) of_mesh[i] = bounds_of(scene.meshes[i]);
    Bounds3 bounds;
    for (const Instance& instance : scene.instances) {
        const Bounds3& local = of_mesh[instance.mesh];
        if (local.is_empty() || instance.is_hidden || instance.is_background) continue;
        for (int corner = 0; corner < 8; ++corner) {
            bounds.extend(transform_point(instance.world_from_local, corner_of(local, corner)));
        }
    }
    return bounds;
}

} // namespace pertev
