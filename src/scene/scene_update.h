#pragma once

// Describes the changes of a scene for everything that is derived from it.

#include <cstdint>
#include <vector>

namespace pertev {

/// Indices into Scene::instances and Scene::meshes. The materials, the numbers of instances and meshes, the mesh of
/// each instance and what may move do not change.
struct SceneUpdate {
    std::vector<uint32_t> moved_instances; // instances whose world_from_local or is_hidden changed
    std::vector<uint32_t> deformed_meshes; // meshes with the same triangles (indices) and other positions or normals
    std::vector<uint32_t> replaced_meshes; // meshes with any other change
    bool lights_changed = false;           // Scene::lights
    bool poses_changed = false;            // PosedScene::poses changed; the rest of Scene changed only as stated
                                           // above

    bool is_empty() const {
        return moved_instances.empty() && deformed_meshes.empty() && replaced_meshes.empty() && !lights_changed &&
               !poses_changed;
    }
};

} // namespace pertev
