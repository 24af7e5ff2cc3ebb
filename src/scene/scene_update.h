#pragma once

// What has become another of a scene: all that whoever keeps something derived from it must look at.

#include <cstdint>
#include <vector>

namespace pertev {

/// Indices into Scene::instances and Scene::meshes. Which materials there are, how many instances and meshes, which
/// mesh an instance shows and what may move stay.
struct SceneUpdate {
    std::vector<uint32_t> moved_instances; // world_from_local or is_hidden is another
    std::vector<uint32_t> deformed_meshes; // the same triangles (indices) with other positions or normals
    std::vector<uint32_t> replaced_meshes; // anything about them
    bool lights_changed = false;           // Scene::lights
    bool poses_changed = false;            // PosedScene::poses; of Scene nothing but what stands above

    bool is_empty() const {
        return moved_instances.empty() && deformed_meshes.empty() && replaced_meshes.empty() && !lights_changed &&
               !poses_changed;
    }
};

} // namespace pertev
