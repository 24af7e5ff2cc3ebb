#pragma once

// A scene as a reader leaves it, at rest, or as it is at a time (scene/pose/posed_scene.h): plain data. Ids are
// positions in these vectors; the order of `instances` is the scene order of the one-picture law (docs/conventions.md).
// What has an `origin` says with it where the file describes it, for messages: a JSON pointer, or a line; empty where
// the format has neither.
//
// All coordinates are relative to `origin_in_file`, which the reader takes off in double before it rounds to floats
// (scene/scene_origin.h). It is 0 where the scene lies at the file's origin.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "math/double_vec3.h"
#include "math/transform.h"
#include "scene/animation.h"
#include "scene/camera.h"
#include "scene/light.h"
#include "scene/material.h"
#include "scene/mesh.h"
#include "scene/mesh_shape.h"
#include "scene/node.h"
#include "scene/texture.h"

namespace pertev {

struct Instance {
    std::string name;
    uint32_t mesh = 0;     // index into Scene::meshes
    uint32_t material = 0; // index into Scene::materials
    Transform world_from_local;
    uint32_t node = kNoNode; // index into Scene::nodes: where it stands, and where the file has it (origin_of)
    Transform
        node_from_local;    // its place within the node: world_from_local is that of the node times it, without a skin
    bool is_hidden = false; // its transform is singular, as by a scale of 0: not there; world_from_local says nothing
    /// Rays meet it, but ids, layers and alpha show it as background, and bounds_of() leaves it out: a made-up ground.
    /// One instance at most is, the last.
    bool is_background = false;
};

/// A setting of pictures by its name (docs/settings.md), and its value in words.
struct SuggestedSetting {
    std::string name, text;
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
    std::vector<MeshShape> shapes;           // of those meshes that morph targets or a skin can move
    std::vector<Animation> animations;       // those that play
    std::vector<Clip> clips;                 // all animations of the file, in its order
    std::vector<std::string> file_scenes;    // the names of all scenes of the file, in its order
    uint32_t file_scene = 0;                 // index into file_scenes: the one that this is
    DoubleVec3 origin_in_file = {0, 0, 0};   // of all coordinates here, in those of the file, metres
    bool is_far = false;                     // it lies over 2^12 of the scene's own sizes from the file's origin
    std::vector<SuggestedSetting> suggested; // by the file: samples, an integrator and its settings, a film
    std::string no_instances;                // where there are none: what the file has instead, and what would be right
};

/// World from local of what has this place within a node; relative to `origin`, in the coordinates of the file.
Transform placed_in(const NodePlace& place, const Transform& node_from_local, DoubleVec3 origin);

/// JSON pointer of the node that an instance comes from; empty for none.
std::string origin_of(const Instance& instance);

/// Whether a transform squeezes one direction so much more than another that its instance is baked into the world at
/// any time at which it does: a condition number over 2^12 (device_scene/place_meshes.h).
inline constexpr float kMaxCondition = 4096;
inline bool is_skewed(const Transform& world_from_local) {
    return !(condition_number(world_from_local) <= kMaxCondition);
}

/// Whether a transform turns the winding of triangles over.
inline bool is_mirroring(const Transform& world_from_local) { return determinant(world_from_local) < 0; }

/// Whether all of `local` lies within kMaxCoordinate once it is placed.
bool lies_near(const Transform& world_from_local, const Bounds3& local);

/// World-space box of all instances that are neither hidden nor background.
Bounds3 bounds_of(const Scene& scene);

} // namespace pertev
