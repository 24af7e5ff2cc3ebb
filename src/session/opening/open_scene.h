#pragma once

// Opens a scene by name so that it is ready to be prepared: reads the file, adds the environment and, if it has no
// light, default light, and decides which faces count. Rendering starts here, then with
// session/opening/choose_camera.h. The fields below have the names of the settings.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/messages.h"
#include "formats/read_scene.h"
#include "scene/scene.h"
#include "session/scene_use.h"
#include "session/set_emitters.h"
#include "settings/picture_options.h"

namespace pertev {

/// A generated ground beneath the scene. Auto adds it if an object is viewed from outside in generated light.
enum class Ground { Off, On, Auto };

struct OpenOptions {
    std::string scene; // a file, or the name of a built-in scene
    SceneUse use = SceneUse::Picture;
    Ground ground = Ground::Off; // Auto only if no camera is requested, not even the file's
    std::vector<std::filesystem::path> allowed_paths;
    std::string up_axis;                     // x, y or z, for OBJ and PLY; empty: y
    std::string unit;                        // for OBJ and PLY, a name or metres; empty: m
    std::filesystem::path environment;       // an .hdr or .exr panorama; empty: none
    std::optional<Rgb> environment_radiance; // uniform radiance instead of a panorama, W/(sr m2), at least 0
    float environment_rotation_deg = 0;      // around +y, added to the environment's own
    float environment_scale = 1;             // factor for the environment's own
    std::vector<EmitterStrength> emitters;   // amounts of light, in order
    double efficacy = 0;                     // lumens per watt, for lamps; 0: by kind of file (photometry.h)
    bool two_sided_lights = false;           // surfaces emit from both faces, whatever the file says
    bool show_back_faces = false;            // the camera sees backs that a glTF file culls
    std::string animation;  // the file's animation to play (formats/files/file_choices.h); empty: its first
    std::string file_scene; // the file's scene to show; empty: its default
};

/// Converts options from text. Throws Error(BadInput) for invalid text.
OpenOptions open_options(const SceneOptions& options);

/// Coordinate system of the file from the settings `up_axis` and `unit`. Throws Error(BadInput) for invalid ones.
FileSpace file_space(const std::string& up_axis, const std::string& unit);

/// Options of reading.
ReadOptions read_options(const OpenOptions& options);

/// The environment in the syntax of `environment`: a file, or a radiance R,G,B; empty: none.
std::string environment_text(const OpenOptions& options);

/// Reads the scene, with the environment of the options or, if it has no light, the default light, and a ground
/// (session/survey/ground.h). An option without effect on this scene gives a warning. The result has passed
/// validate(). Throws Error.
Scene open_scene(const OpenOptions& options, Messages& messages);

/// Reads a scene with `formats/read_scene.h` and adds nothing. Says which scene of a file with several is shown and,
/// for files that cannot say which faces of a lamp emit, comments on its lamps (session/survey/emitter_fronts.h).
/// Throws Error.
Scene read_scene_and_emitters(const std::filesystem::path& path, const ReadOptions& options, Messages& messages);

} // namespace pertev
