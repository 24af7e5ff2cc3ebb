#pragma once

// A scene as a reader leaves it: plain data, nothing derived. Ids are positions in these vectors; the order of
// `instances` is the scene order of the one-picture law (docs/conventions.md). What has an `origin` says with it where
// the file describes it, for messages: a JSON pointer, or a line; empty where the format has neither.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "math/transform.h"
#include "scene/animation.h"
#include "scene/camera.h"
#include "scene/light.h"
#include "scene/material.h"
#include "scene/mesh.h"
#include "scene/node.h"
#include "scene/texture.h"

namespace pertev {

struct Instance {
    std::string name;
    uint32_t mesh = 0;     // index into Scene::meshes
    uint32_t material = 0; // index into Scene::materials
    Transform world_from_local;
    uint32_t node = kNoNode; // index into Scene::nodes: where it stands, and where the file has it (origin_of)
};

struct Scene {
    std::vector<Mesh> meshes;
    std::vector<Material> materials;
    std::vector<TextureImage> images;
    std::vector<Instance> instances;
    std::vector<Light> lights;
    std::optional<Environment> environment;
    std::vector<Camera> cameras;
    std::vector<Node> nodes; // a glTF file's, by their numbers there; also those that hold nothing
    std::vector<Skin> skins;
    std::vector<Animation> animations;
    std::string no_instances; // where there are none: what the file has instead, and what would be right
};

/// JSON pointer of the node that an instance comes from; empty for none.
std::string origin_of(const Instance& instance);

/// Whether a transform turns the winding of triangles over.
inline bool is_mirroring(const Transform& world_from_local) { return determinant(world_from_local) < 0; }

/// World-space box of all instances.
Bounds3 bounds_of(const Scene& scene);

} // namespace pertev
