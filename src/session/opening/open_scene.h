#pragma once

// From a name to a scene that is ready to be prepared: the file read, its environment, its light if it has none, and
// which faces count. Whoever renders begins here, then with session/opening/choose_camera.h. The fields below are
// called after the settings.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/messages.h"
#include "formats/read_scene.h"
#include "scene/scene.h"
#include "session/scene_use.h"
#include "session/set_lamps.h"
#include "settings/picture_options.h"

namespace pertev {

/// A made-up ground beneath the scene. Auto: where a thing is to be seen from outside, in made-up light.
enum class Ground { Off, On, Auto };

struct OpenOptions {
    std::string scene; // a file, or a built-in scene's name
    SceneUse use = SceneUse::Picture;
    Ground ground = Ground::Off; // Auto only where no camera is asked for: none of the file's counts either
    std::vector<std::filesystem::path> allowed_paths;
    std::string up_axis;                     // x, y or z, of OBJ and PLY; empty: y
    std::string unit;                        // of OBJ and PLY, a name or metres; empty: m
    std::filesystem::path environment;       // an .hdr or .exr panorama; empty: none
    std::optional<Rgb> environment_radiance; // instead of a panorama: from everywhere, W/(sr m2), at least 0
    float environment_rotation_deg = 0;      // about +y, added to the environment's own
    float environment_scale = 1;             // times the environment's own
    std::vector<LampStrength> lamps;         // set to amounts of light, in their order
    double efficacy = 0;           // lumens of a watt, for lamps; 0: as the kind of file has it (photometry.h)
    bool two_sided_lights = false; // surfaces emit from both faces, whatever the file says
    bool show_back_faces = false;  // the camera sees backs that a glTF file hides
    std::string animation;         // of the file, plays (formats/files/file_choices.h); empty: its first
    std::string file_scene;        // of the file, is shown; empty: the file's own choice
};

/// Returns the options of a scene as they stand in words. Throws Error(BadInput) for text that is no value.
OpenOptions open_options(const SceneOptions& options);

/// How the file's coordinates are meant, by the words of `up_axis` and `unit`. Throws Error(BadInput) for others.
FileSpace file_space(const std::string& up_axis, const std::string& unit);

/// Reading as these options say it.
ReadOptions read_options(const OpenOptions& options);

/// The environment that is asked for, in the words of `environment`: a file, or a radiance R,G,B; empty: none.
std::string environment_text(const OpenOptions& options);

/// The scene read, with the environment that the options give it or else, where it has no light, the default light, and
/// a ground (session/survey/ground.h). An option that this scene makes useless is a warning. The scene has been through
/// validate(). Throws Error.
Scene open_scene(const OpenOptions& options, Messages& messages);

/// What `formats/read_scene.h` reads, with nothing added. Says which scene of a file is shown that has several, and
/// what there is to say of its lamps in files that cannot tell which faces of a lamp shine
/// (session/survey/lamp_fronts.h). Throws Error.
Scene read_scene_and_lamps(const std::filesystem::path& path, const ReadOptions& options, Messages& messages);

} // namespace pertev
