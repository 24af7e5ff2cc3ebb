#pragma once

// Describes the changes of a scene for everything that is derived from it.

#include <cstdint>
#include <vector>

namespace pertev {

/// Indices into Scene::instances and Scene::meshes. The numbers of all objects, the mesh and the material of each
/// instance and what may move do not change.
struct SceneUpdate {
    std::vector<uint32_t> moved_instances; // instances whose world_from_local or is_hidden changed
    std::vector<uint32_t> deformed_meshes; // meshes with the same triangles (indices) and other positions or normals
    std::vector<uint32_t> replaced_meshes; // meshes with any other change
    bool lights_changed = false;           // Scene::lights, or parameters of materials that emit
    bool poses_changed = false;            // PosedScene::poses changed; the rest of Scene changed only as stated
                                           // above
    bool materials_changed = false;        // numbers of materials (visit_parameters)
    bool environment_changed = false;      // Scene::environment, which is there as before

    /// Returns whether surfaces are unchanged, except for poses.
    bool keeps_surfaces() const {
        return moved_instances.empty() && deformed_meshes.empty() && replaced_meshes.empty();
    }
    bool is_empty() const {
        return keeps_surfaces() && !lights_changed && !poses_changed && !materials_changed && !environment_changed;
    }
    SceneUpdate& operator+=(const SceneUpdate& other) {
        const auto add = [](std::vector<uint32_t>& to, const std::vector<uint32_t>& from) {
            to.insert(to.end(), from.begin(), from.end());
        };
        add(moved_instances, other.moved_instances);
        add(deformed_meshes, other.deformed_meshes);
        add(replaced_meshes, other.replaced_meshes);
        lights_changed |= other.lights_changed;
        materials_changed |= other.materials_changed;
        poses_changed |= other.poses_changed;
        environment_changed |= other.environment_changed;
        return *this;
    }
};

} // namespace pertev
