#pragma once

// Scene options of all verbs with a scene: wrappers of the session's functions that parse the texts of flags.

#include <string>

#include "base/sink.h"
#include "scene/scene.h"
#include "settings/picture_options.h"

namespace CLI {
class App;
class Option;
} // namespace CLI

namespace pertev {

/// Adds the positional argument SCENE.
CLI::Option* add_scene_name(CLI::App& verb, SceneOptions& options);
/// Names of all built-in scenes, for help.
std::string builtin_scene_list();

/// Reads a file, or a built-in scene by its name, and adds nothing (session/opening/open_scene.h's
/// read_scene_and_emitters). Throws Error.
Scene read_any_scene(const SceneOptions& options, Sink& sink);

} // namespace pertev
