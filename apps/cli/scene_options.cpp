#include "apps/cli/scene_options.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/flag_checks.h"
#include "base/limits.h"
#include "formats/builtin_scenes.h"
#include "session/opening/open_scene.h"
#include "session/photometry.h"
#include "settings/parse_values.h"

namespace pertev {

OpenOptions open_options(const SceneOptions& options) {
    OpenOptions open;
    open.scene = options.scene;
    open.allowed_paths = options.allowed_paths;
    open.up_axis = options.up_axis;
    open.unit = options.unit;
    if (Rgb radiance; parse_rgb(options.environment, radiance)) {
        open.environment_radiance = radiance;
    } else {
        open.environment = options.environment;
    }
    open.environment_rotation_deg = options.environment_rotation_deg;
    open.environment_scale = options.environment_scale;
    for (const std::string& lamp : options.lamps) open.lamps.push_back(parse_lamp(lamp));
    open.efficacy = static_cast<double>(options.efficacy);
    open.two_sided_lights = options.two_sided_lights;
    open.show_back_faces = options.show_back_faces;
    open.animation = options.animation;
    open.file_scene = options.file_scene;
    return open;
}

double efficacy_of(const SceneOptions& options) {
    return lumens_per_watt(options.scene, static_cast<double>(options.efficacy));
}

void check_scene_options(const SceneOptions& options) {
    check_camera_choice(options.camera);
    read_options(open_options(options));
}

std::string builtin_scene_list() { return fmt::format("{}", fmt::join(builtin_scene_names(), ", ")); }

CLI::Option* add_scene_name(CLI::App& verb, SceneOptions& options) {
    return verb
        .add_option("SCENE", options.scene,
                    "A .gltf, .glb, .obj or .ply file, or a built-in scene: " + builtin_scene_list())
        ->type_name("")
        ->check(file_name())
        ->required();
}

Scene read_any_scene(const SceneOptions& options, Messages& messages) {
    return read_scene_and_lamps(options.scene, read_options(open_options(options)), messages);
}

Scene load_scene(const SceneOptions& options, SceneUse use, Messages& messages) {
    OpenOptions open = open_options(options);
    open.use = use;
    return open_scene(open, messages);
}

} // namespace pertev
