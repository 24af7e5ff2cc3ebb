#pragma once

// A scene as a reader makes it, at rest, or at a time (scene/pose/posed_scene.h): plain data. Ids are indices into
// these vectors; the order of `instances` is the scene order of the one-picture law (docs/conventions.md). An
// `origin` is the location of an object in its file, for messages: a JSON pointer or a line; empty if the format has
// neither.
//
// All coordinates are relative to `origin_in_file`, which the reader subtracts in double before rounding to floats
// (scene/scene_origin.h). It is 0 if the scene is near the file's origin.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "math/double_vec3.h"
#include "math/transform.h"
#include "scene/animation.h"
#include "scene/camera.h"
#include "scene/light.h"
#include "scene/material.h"
#include "scene/medium.h"
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
    uint32_t node = kNoNode;   // index into Scene::nodes, of the node that carries it and that the file describes
                               // (origin_of)
    Transform node_from_local; // transform within the node, without a skin: world_from_local is the product of the
                               // node's and this
    bool is_hidden = false;    // an animation hides its node, or the transform is singular, for example by a scale of
                               // 0: it does not exist, and world_from_local is undefined
    /// True for a generated ground: rays hit it, but ids, layers and alpha treat it as background, and bounds_of()
    /// ignores it. Only the last instance may be one.
    bool is_background = false;
    /// Number of instances directly before this one that are the same triangles in the same place. Their alphas
    /// decide which of such layers a ray hits; the first one comes first.
    uint32_t layers_above = 0;
};

/// A suggested value of a setting, by the setting's name (docs/settings.md).
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
    MediumParameters medium; // fills all space that no body with a surface fills
    std::vector<Camera> cameras;
    std::vector<Node> nodes; // all nodes of a glTF file by their numbers there, including empty ones
    std::vector<Skin> skins;
    std::vector<MeshShape> shapes;            // for meshes that morph targets or a skin can deform
    std::vector<Animation> animations;        // animations that play
    std::vector<Clip> clips;                  // all animations of the file, in its order
    std::vector<std::string> file_scenes;     // names of all scenes of the file, in its order
    uint32_t file_scene = 0;                  // index of this scene in file_scenes
    std::vector<std::string> variants;        // names of the file's sets of materials
    std::optional<uint32_t> variant;          // index of the one shown; none: the file's default materials
    DoubleVec3 origin_in_file = {0, 0, 0};    // origin of all coordinates here, in those of the file, metres
    bool is_far = false;                      // the scene is over 2^12 of its own sizes away from the file's origin
    std::vector<SuggestedSetting> suggested;  // suggestions of the file: samples, an integrator and its settings, a
                                              // film
    std::vector<std::filesystem::path> files; // files that its own file refers to, in the order of reading
    bool bakes_small_meshes = true;           // false: keeps each shared mesh as one (device_scene/place_meshes.h)
    std::string no_instances;                 // if there are no instances: what the file has instead, and what would
                                              // be right
};

/// World-from-local transform of an object with this transform within a node; relative to `origin`, in the
/// coordinates of the file.
Transform placed_in(const NodeTransform& transform, const Transform& node_from_local, DoubleVec3 origin);

/// Returns whether a medium fills any part of space: the scene's own, or one in a body.
bool has_media(const Scene& scene);

/// JSON pointer of the node that an instance comes from; empty if there is none.
std::string origin_of(const Instance& instance);

/// Maximum condition number of a transform. An instance that exceeds it at any time is baked into the world
/// (device_scene/place_meshes.h).
inline constexpr float kMaxCondition = 4096;
inline bool is_skewed(const Transform& world_from_local) {
    return !(condition_number(world_from_local) <= kMaxCondition);
}

/// Returns whether a transform reverses the winding of triangles.
inline bool is_mirroring(const Transform& world_from_local) { return determinant(world_from_local) < 0; }

/// Returns whether all of `local` lies within kMaxCoordinate after the transform.
bool is_within_limits(const Transform& world_from_local, const Bounds3& local);

/// World-space box of all instances that are neither hidden nor background.
Bounds3 bounds_of(const Scene& scene);

} // namespace pertev
