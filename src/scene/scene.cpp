#include "scene/scene.h"

namespace pertev {

std::string origin_of(const Instance& instance) {
    return instance.node == kNoNode ? "" : "/nodes/" + std::to_string(instance.node);
}

Bounds3 bounds_of(const Mesh& mesh) {
    Bounds3 bounds;
    for (const uint32_t index : mesh.indices) bounds.extend(mesh.positions[index]);
    return bounds;
}

Bounds3 bounds_of(const Scene& scene) {
    std::vector<Bounds3> of_mesh(scene.meshes.size());
    for (std::size_t i = 0; i < scene.meshes.size(); ++i) of_mesh[i] = bounds_of(scene.meshes[i]);
    Bounds3 bounds;
    for (const Instance& instance : scene.instances) {
        const Bounds3& local = of_mesh[instance.mesh];
        if (local.is_empty()) continue;
        for (int corner = 0; corner < 8; ++corner) {
            bounds.extend(transform_point(instance.world_from_local,
                                          {corner & 1 ? local.hi.x : local.lo.x, corner & 2 ? local.hi.y : local.lo.y,
                                           corner & 4 ? local.hi.z : local.lo.z}));
        }
    }
    return bounds;
}

} // namespace pertev
