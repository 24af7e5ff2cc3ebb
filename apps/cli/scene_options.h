#pragma once

// What every verb that takes a scene shares: the session's functions for the options of a scene, whose texts are read
// here.

#include <string>

#include "base/messages.h"
#include "session/opening/choose_camera.h"
#include "session/opening/open_scene.h"
#include "settings/picture_options.h"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace pertev {

/// Adds SCENE.
CLI::Option* add_scene_name(CLI::App& verb, SceneOptions& options);
/// The names of all built-in scenes, for help.
std::string builtin_scene_list();

/// What can be told before the scene is read. Throws Error(BadInput) for a flag that another one makes useless.
void check_scene_options(const SceneOptions& options);

/// A file, or a built-in scene by its name, with nothing added (session/opening/open_scene.h's read_scene_and_lamps).
/// Throws Error.
Scene read_any_scene(const SceneOptions& options, Messages& messages);

// The rest is session/opening/open_scene.h and session/opening/choose_camera.h for flags as they stand on the command
// line. Each throws Error(BadInput) also for text that is no value.

Scene load_scene(const SceneOptions& options, SceneUse use, Messages& messages);

} // namespace pertev
