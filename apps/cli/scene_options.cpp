#include "apps/cli/scene_options.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/flag_checks.h"
#include "formats/builtin_scenes.h"
#include "session/opening/open_scene.h"

namespace pertev {

std::string builtin_scene_list() { return fmt::format("{}", fmt::join(builtin_scene_names(), ", ")); }

CLI::Option* add_scene_name(CLI::App& verb, SceneOptions& options) {
    return verb
        .add_option("SCENE", options.scene,
                    "A .gltf, .glb, .obj, .ply, .stl, .pbrt or .xml file, or a built-in scene: " + builtin_scene_list())
        ->type_name("")
        ->check(file_name())
        ->required();
}

Scene read_any_scene(const SceneOptions& options, Sink& sink) {
    Scene scene = read_scene_and_emitters(options.scene, read_options(options), sink);
    change_materials(options, scene, sink);
    return scene;
}

} // namespace pertev
