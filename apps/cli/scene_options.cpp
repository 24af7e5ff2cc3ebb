#include "apps/cli/scene_options.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/flag_checks.h"
#include "apps/cli/parse_values.h"
#include "base/limits.h"
#include "formats/builtin_scenes.h"
#include "session/opening/open_scene.h"
#include "session/photometry.h"

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

CameraChoice camera_choice(const SceneOptions& options) {
    CameraChoice choice;
    choice.camera = options.camera;
    if (!options.eye.empty()) choice.eye = parse_position("--eye", options.eye);
    if (!options.target.empty()) choice.target = parse_position("--target", options.target);
    if (!options.up.empty()) choice.up = parse_vec3("--up", options.up);
    if (options.fov_deg > 0) choice.fov_deg = options.fov_deg;
    if (options.aperture_m >= 0) choice.aperture = options.aperture_m;
    if (options.focus_m > 0) choice.focus = options.focus_m;
    if (options.projection == "perspective") choice.projection = Projection::Perspective;
    if (options.projection == "orthographic") choice.projection = Projection::Orthographic;
    if (options.view_height_m > 0) choice.view_height = options.view_height_m;
    return choice;
}

void check_scene_options(const SceneOptions& options) {
    check_camera_choice(camera_choice(options));
    read_options(open_options(options));
}

std::string builtin_scene_list() { return fmt::format("{}", fmt::join(builtin_scene_names(), ", ")); }

void add_scene_name(CLI::App& verb, SceneOptions& options) {
    verb.add_option("SCENE", options.scene,
                    "a .gltf, .glb, .obj or .ply file, or a built-in scene:\n" + builtin_scene_list())
        ->type_name("")
        ->check(file_name())
        ->required();
    add_file_scene(verb, options);
}

void add_file_scene(CLI::App& verb, SceneOptions& options) {
    verb.add_option("--file-scene", options.file_scene,
                    "of a glTF file with several scenes: the one of this name or\nnumber, from 0 (the file's default)")
        ->type_name("NAME|N")
        ->check(file_name());
}

void add_animation(CLI::App& verb, SceneOptions& options) {
    verb.add_option("--animation", options.animation,
                    "of a file with several animations: what plays, by its name or\nnumber, from 0; all: every one at "
                    "once (the first)")
        ->type_name("NAME|N|all")
        ->check(file_name())
        ->group("Motion");
}

void add_view_options(CLI::App& verb, SceneOptions& options) {
    add_scene_name(verb, options);
    const char* group = "Camera";
    verb.add_option("--camera", options.camera, "the scene's camera of this name or number, from 0")
        ->type_name("NAME|N")
        ->group(group);
    verb.add_option("--eye", options.eye, "where the camera is, metres; looks at the scene's middle\nwithout --target")
        ->type_name("X,Y,Z")
        ->group(group);
    verb.add_option("--target", options.target, "what it looks at")->type_name("X,Y,Z")->group(group);
    verb.add_option("--up", options.up, "upwards (0,1,0)")->type_name("X,Y,Z")->group(group);
    verb.add_option("--fov", options.fov_deg, "full vertical angle of view, degrees")
        ->type_name("DEG")
        ->check(number_between(0.01f, 179.0f))
        ->group(group);
    verb.add_option("--projection", options.projection, "perspective or orthographic")
        ->type_name("NAME")
        ->check(one_of({"perspective", "orthographic"}))
        ->group(group);
    verb.add_option("--view-height", options.view_height_m,
                    "of an orthographic view: its full height, metres (as much as\nthe perspective view shows)")
        ->type_name("M")
        ->check(length_m())
        ->group(group);
    add_read_options(verb, options);
}

namespace {

void add_lens_options(CLI::App& verb, SceneOptions& options) {
    const char* group = "Camera";
    verb.add_option("--aperture", options.aperture_m, "radius of the lens, metres; 0: everything is sharp")
        ->type_name("M")
        ->check(number_between(0, kMaxCoordinate))
        ->group(group);
    verb.add_option("--focus", options.focus_m,
                    "of a lens with an aperture: distance in focus, metres (that of\n--target, else of what is in the "
                    "middle of the picture)")
        ->type_name("M")
        ->check(length_m())
        ->group(group);
}

} // namespace

void add_light_options(CLI::App& verb, SceneOptions& options) {
    const char* group = "Environment";
    verb.add_option("--environment", options.environment, "an .hdr or .exr panorama, or R,G,B: light from far away")
        ->type_name("FILE|R,G,B")
        ->group(group);
    verb.add_option("--environment-rotation", options.environment_rotation_deg, "turned about +y; of a made-up sky too")
        ->type_name("DEG")
        ->check(number_between(-1e6f, 1e6f))
        ->group(group);
    verb.add_option("--environment-scale", options.environment_scale, "times its radiance; of a made-up sky too")
        ->type_name("X")
        ->check(number_between(0, 1e12f))
        ->group(group);
    group = "Lamps";
    verb.add_option(
            "--lamp", options.lamps,
            "set every lamp of this name (* and ? stand for letters) to so\nmuch light: W, lm, cd, lx or nits, as "
            "bulb=800lm; may be given again")
        ->type_name("NAME=AMOUNT")
        ->allow_extra_args(false)
        ->group(group);
    verb.add_option("--efficacy", options.efficacy,
                    "lumens of a watt (683; 1 for glTF, whose candela, lux and nits\nare read as watts)")
        ->type_name("LM_PER_W")
        ->check(number_above_zero(1e6f))
        ->group(group);
    verb.add_flag("--two-sided-lights", options.two_sided_lights, "lamps shine from both faces, whatever the file says")
        ->group("Faces");
}

void add_scene_options(CLI::App& verb, SceneOptions& options) {
    add_view_options(verb, options);
    add_lens_options(verb, options);
    add_light_options(verb, options);
    verb.add_flag("--show-back-faces", options.show_back_faces,
                  "let the camera see backs that a glTF file hides\n(doubleSided: false)")
        ->group("Faces");
    add_animation(verb, options);
}

void add_read_options(CLI::App& verb, SceneOptions& options) {
    verb.add_option("--allow-path", options.allowed_paths,
                    "a folder outside the scene's own that it may read from; may be given again")
        ->type_name("DIR")
        ->allow_extra_args(false)
        ->check(CLI::Validator(CLI::ExistingDirectory).description(""));
    const char* group = "Coordinates of .obj and .ply";
    verb.add_option("--up-axis", options.up_axis,
                    "which way is up in the file (y); all flags are for a scene with y up")
        ->type_name("x|y|z")
        ->group(group);
    verb.add_option("--unit", options.unit,
                    fmt::format("of the file, {} or metres (m);\nall flags are for a scene in metres", kUnitNames))
        ->type_name("UNIT|M")
        ->group(group);
}

Scene read_any_scene(const SceneOptions& options, Messages& messages) {
    return read_scene_and_lamps(options.scene, read_options(open_options(options)), messages);
}

Scene load_scene(const SceneOptions& options, SceneUse use, Messages& messages) {
    OpenOptions open = open_options(options);
    open.use = use;
    return open_scene(open, messages);
}

const Camera* scene_camera(const SceneOptions& options, const Scene& scene) {
    return scene_camera(options.camera, scene);
}

Camera choose_camera(const SceneOptions& options, const Scene& scene, float aspect, Messages& messages) {
    return choose_camera(camera_choice(options), scene, aspect, messages);
}

} // namespace pertev
