#pragma once

// What every verb that takes a scene shares: the scene itself, its camera and its environment, as flags.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/messages.h"
#include "scene/scene.h"

namespace CLI {
class App;
}

namespace pertev {

struct SceneOptions {
    std::string scene;
    std::vector<std::filesystem::path> allowed_paths;
    std::string camera; // name or number
    std::string eye, target, up;
    bool is_aimed = false; // the target is made up (apps/cli/aim_camera.h)
    float fov_deg = 0;     // 0: the camera's own
    float aperture_m = -1, focus_m = 0;
    std::string projection; // "", "perspective", "orthographic"
    float view_height_m = 0;
    std::string environment; // file or "r,g,b"
    float environment_rotation_deg = 0, environment_scale = 1;
    bool two_sided_lights = false, show_back_faces = false;
};

/// SCENE, its camera, its environment and which faces count.
void add_scene_options(CLI::App& verb, SceneOptions& options);
/// The same without the environment, the faces and the lens, for verbs that look at geometry alone, through its middle.
void add_view_options(CLI::App& verb, SceneOptions& options);
/// --allow-path alone.
void add_allow_path(CLI::App& verb, std::vector<std::filesystem::path>& folders);

/// What can be told before the scene is read. Throws Error(BadInput) for a flag that another one makes useless.
void check_scene_options(const SceneOptions& options);

/// A file, or a built-in scene by its name. Throws Error.
Scene read_any_scene(const std::string& name, const std::vector<std::filesystem::path>& allowed_paths,
                     Messages& messages);

/// The scene read, with the environment that the flags or the defaults give it. A flag that this scene makes useless is
/// a warning. Throws Error.
Scene load_scene(const SceneOptions& options, Messages& messages);

/// The scene's own camera: the one that --camera names, else the first, else null. Throws Error(BadInput) that lists
/// those there are when none is named so.
const Camera* scene_camera(const SceneOptions& options, const Scene& scene);

/// The camera that the flags or the scene or the defaults give, for a picture of this width / height. A flag that this
/// camera makes useless is a warning. Throws Error(BadInput).
Camera choose_camera(const SceneOptions& options, const Scene& scene, float aspect, Messages& messages);

} // namespace pertev
