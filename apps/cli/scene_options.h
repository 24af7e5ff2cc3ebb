#pragma once

// What every verb that takes a scene shares: the scene itself, its camera and its environment, as flags: their texts,
// and the session's functions for them.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/messages.h"
#include "session/opening/choose_camera.h"
#include "session/opening/open_scene.h"

namespace CLI {
class App;
}

namespace pertev {

struct SceneOptions {
    std::string scene;
    std::vector<std::filesystem::path> allowed_paths;
    std::string up_axis, unit; // of the file's coordinates
    std::string camera;        // name or number
    std::string eye, target, up;
    float fov_deg = 0; // 0: the camera's own
    float aperture_m = -1, focus_m = 0;
    std::string projection; // "", "perspective", "orthographic"
    float view_height_m = 0;
    std::string environment; // file or "r,g,b"
    float environment_rotation_deg = 0, environment_scale = 1;
    std::vector<std::string> lamps; // --lamp
    float efficacy = 0;             // lm/W; 0: by the kind of file
    bool two_sided_lights = false, show_back_faces = false;
    std::string animation, file_scene; // names or numbers; empty: the first, and the file's own choice
};

/// SCENE, its camera, its environment and which faces count.
void add_scene_options(CLI::App& verb, SceneOptions& options);
/// The same without the environment, the faces and the lens, for verbs that look at geometry alone, through its middle.
void add_view_options(CLI::App& verb, SceneOptions& options);
/// SCENE, and which scene of the file it is.
void add_scene_name(CLI::App& verb, SceneOptions& options);
/// The names of all built-in scenes, for help.
std::string builtin_scene_list();
/// --file-scene alone.
void add_file_scene(CLI::App& verb, SceneOptions& options);
/// --animation alone; add_scene_options has it.
void add_animation(CLI::App& verb, SceneOptions& options);
/// The environment, lamps and --two-sided-lights alone.
void add_light_options(CLI::App& verb, SceneOptions& options);
/// Adds what a file's reader takes, --allow-path, --up-axis and --unit, alone.
void add_read_options(CLI::App& verb, SceneOptions& options);

/// What can be told before the scene is read. Throws Error(BadInput) for a flag that another one makes useless.
void check_scene_options(const SceneOptions& options);

/// A file, or a built-in scene by its name, with nothing added (session/opening/open_scene.h's read_scene_and_lamps).
/// Throws Error.
Scene read_any_scene(const SceneOptions& options, Messages& messages);

// The rest is session/opening/open_scene.h and session/opening/choose_camera.h for flags as they stand on the command
// line. Each throws Error(BadInput) also for text that is no value.

/// Lumens that a watt of the scene counts as: --efficacy, or by the kind of file.
double efficacy_of(const SceneOptions& options);
OpenOptions open_options(const SceneOptions& options);
Scene load_scene(const SceneOptions& options, SceneUse use, Messages& messages);
const Camera* scene_camera(const SceneOptions& options, const Scene& scene);
CameraChoice camera_choice(const SceneOptions& options);
Camera choose_camera(const SceneOptions& options, const Scene& scene, float aspect, Messages& messages);

} // namespace pertev
