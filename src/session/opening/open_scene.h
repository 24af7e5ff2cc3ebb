#pragma once

// Opens a scene by name so that it is ready to be prepared: reads the file, adds the environment and, if it has no
// light, default light, and decides which faces count. Rendering starts here, then with
// session/opening/choose_camera.h.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/sink.h"
#include "formats/read_scene.h"
#include "formats/sun_sky/sun_sky.h"
#include "scene/scene.h"
#include "session/set_emitters.h"
#include "session/survey/default_light.h"
#include "settings/picture_options.h"

namespace pertev {

/// A generated ground beneath the scene. Auto adds it if an object is viewed from outside in generated light.
enum class Ground { Off, On, Auto };

/// Coordinate system of the file from the settings `up_axis` and `unit`. Throws Error(BadInput) for invalid ones.
FileSpace file_space(const std::string& up_axis, const std::string& unit);

/// Options of reading. Throws Error(BadInput) for invalid text, as do the functions below.
ReadOptions read_options(const SceneOptions& options);

/// The environment in the syntax of `environment`: a file, or a radiance R,G,B; empty: none.
std::string environment_text(const SceneOptions& options);

/// The sky of the setting `sun_sky`, which is not empty.
SunSky sun_sky(const SceneOptions& options);

/// Gives a scene that has passed validate() in place of that of the file, for scenes that are made in memory.
using ReadScene = std::function<Scene(Sink& sink)>;

/// Reads the scene, with the environment of the options or, if it has no light, the default light, and a ground
/// (session/survey/ground.h). An option without effect on this scene gives a warning. The result has passed
/// validate(). Throws Error.
Scene open_scene(const SceneOptions& options, Sink& sink, SceneUse use = SceneUse::Picture, Ground ground = Ground::Off,
                 const ReadScene& read = {});
/// Sets the parameters of materials that the options state.
void change_materials(const SceneOptions& options, Scene& scene, Sink& sink);
/// Opens a scene with all other settings at their defaults.
Scene open_scene(const std::string& scene, Sink& sink, SceneUse use = SceneUse::Picture);

/// Reads a scene with `formats/read_scene.h` and adds nothing. A notice names the shown scene of a file with several.
/// If the format cannot say which faces of an emitter emit, a notice names the emitters that emit on one side
/// (session/survey/emitter_fronts.h). Throws Error.
Scene read_scene_and_emitters(const std::filesystem::path& path, const ReadOptions& options, Sink& sink);

} // namespace pertev
