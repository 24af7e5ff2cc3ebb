#include "apps/cli/scene_options.h"

#include <algorithm>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/aim_camera.h"
#include "apps/cli/flag_checks.h"
#include "apps/cli/parse_values.h"
#include "base/error.h"
#include "formats/read_environment.h"
#include "formats/read_scene.h"
#include "math/portable_math.h"
#include "scene/defaults.h"

namespace pertev {
namespace {

constexpr float kRadiansPerDegree = kPi / 180.0f;

Environment environment_of(const SceneOptions& options, Messages& messages) {
    Environment environment;
    if (Rgb color; parse_rgb(options.environment, color)) {
        if (color.r < 0 || color.g < 0 || color.b < 0) {
            throw Error(ErrorCode::BadInput,
                        fmt::format("--environment {}: radiance cannot be negative", options.environment));
        }
        environment.scale = color;
        return environment;
    }
    if (!std::filesystem::exists(options.environment)) {
        throw Error(ErrorCode::BadInput, fmt::format("--environment {}: neither a file nor a radiance R,G,B such as "
                                                     "0.5,0.5,0.5",
                                                     options.environment));
    }
    environment.image = read_environment_image(options.environment, messages);
    return environment;
}

/// The scene's camera of that name or number (from 0).
const Camera& named_camera(const std::string& name, const Scene& scene) {
    for (const Camera& camera : scene.cameras) {
        if (camera.name == name) return camera;
    }
    if (const auto number = whole_number_in(name); number && *number < scene.cameras.size()) {
        return scene.cameras[*number];
    }
    std::string known;
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        known += fmt::format("\n  {}  {}", i, scene.cameras[i].name.empty() ? "(no name)" : scene.cameras[i].name);
    }
    throw Error(ErrorCode::BadInput, fmt::format("--camera {}: the scene has no such camera; it has:{}", name,
                                                 known.empty() ? "\n  none" : known));
}

void place_camera(const SceneOptions& options, Camera& camera) {
    if (options.eye.empty() && options.target.empty() && options.up.empty()) return;
    const Transform& from = camera.world_from_camera;
    const Vec3 eye = options.eye.empty() ? from.translation : parse_position("--eye", options.eye);
    const Vec3 target = options.target.empty() ? eye - column(from, 2) : parse_position("--target", options.target);
    const Vec3 up = options.up.empty() ? Vec3{0, 1, 0} : parse_vec3("--up", options.up);
    Transform placed = look_at(eye, target, up);
    if (!is_finite(placed.row0) && options.up.empty()) placed = look_at(eye, target, {0, 0, -1}); // straight down or up
    if (!is_finite(placed.row0) || !is_finite(placed.row1) || !is_finite(placed.row2)) {
        const std::string of_up = options.up.empty() ? "" : fmt::format(" and not lie along --up {}", options.up);
        throw Error(ErrorCode::BadInput,
                    fmt::format("--eye {},{},{} --target {},{},{}: the target must differ from the eye{}", eye.x, eye.y,
                                eye.z, target.x, target.y, target.z, of_up));
    }
    camera.world_from_camera = placed;
    if (!options.target.empty()) camera.focus_distance = length(target - eye);
}

/// For a scene without a camera and flags without an eye.
Camera make_camera(const SceneOptions& options, const Scene& scene, float aspect, Messages& messages) {
    if (options.target.empty()) return make_default_camera(scene, aspect, messages);
    Messages unsaid; // of a view that is not to be: it looks elsewhere
    const Camera camera = make_default_camera(scene, aspect, unsaid);
    const Vec3 eye = camera.world_from_camera.translation;
    messages.note(fmt::format("no camera in the scene: a made-up eye looks at the target (--eye {:.4g},{:.4g},{:.4g} "
                              "--target {})",
                              eye.x, eye.y, eye.z, options.target));
    return camera;
}

/// Turns a perspective camera into an orthographic one that shows as much of what it looks at.
void flatten(const SceneOptions& options, const Scene& scene, Camera& camera) {
    const Vec3 eye = camera.world_from_camera.translation, forward = -column(camera.world_from_camera, 2);
    const Bounds3 bounds = bounds_of(scene);
    const float distance = options.target.empty() ? dot(0.5f * (bounds.lo + bounds.hi) - eye, forward)
                                                  : length(parse_position("--target", options.target) - eye);
    camera.projection = Projection::Orthographic;
    if (distance > 0) camera.ortho_height = min(2 * tan(0.5f * camera.fov_y) * distance, kMaxCoordinate);
}

/// `flattened`: the camera's angle of view has become a height.
void warn_of_useless_flags(const SceneOptions& options, const Camera& camera, bool flattened, Messages& messages) {
    const bool is_perspective = camera.projection == Projection::Perspective;
    if (options.view_height_m > 0 && is_perspective) {
        messages.warn("--view-height: the camera is a perspective one; --projection orthographic makes use of it");
    }
    if (options.fov_deg > 0 && !is_perspective && (!flattened || options.view_height_m > 0)) {
        messages.warn("--fov: the camera is an orthographic one, whose view has a height; --view-height sets that");
    }
    if (options.focus_m > 0 && camera.aperture_radius == 0) {
        messages.warn("--focus: the lens has no aperture, so all is sharp; --aperture gives it one");
    }
}

} // namespace

void check_scene_options(const SceneOptions& options) {
    if (options.view_height_m > 0 && options.projection == "perspective") {
        throw Error(ErrorCode::BadInput, "--view-height: a perspective view has none; say --fov, or "
                                         "--projection orthographic");
    }
    if (options.focus_m > 0 && options.aperture_m == 0) {
        throw Error(ErrorCode::BadInput, "--focus: with --aperture 0 all is sharp; give the lens a radius");
    }
}

void add_view_options(CLI::App& verb, SceneOptions& options) {
    verb.add_option("SCENE", options.scene, "a .gltf, .glb, .obj or .ply file, or a built-in scene: cornell-box")
        ->type_name("")
        ->check(file_name())
        ->required();
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
    add_allow_path(verb, options.allowed_paths);
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

void add_scene_options(CLI::App& verb, SceneOptions& options) {
    add_view_options(verb, options);
    add_lens_options(verb, options);
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
    group = "Faces";
    verb.add_flag("--two-sided-lights", options.two_sided_lights, "lamps shine from both faces, whatever the file says")
        ->group(group);
    verb.add_flag("--show-back-faces", options.show_back_faces,
                  "let the camera see backs that a glTF file hides\n(doubleSided: false)")
        ->group(group);
}

void add_allow_path(CLI::App& verb, std::vector<std::filesystem::path>& folders) {
    verb.add_option("--allow-path", folders,
                    "a folder outside the scene's own that it may read from; may be given again")
        ->type_name("DIR")
        ->allow_extra_args(false)
        ->check(CLI::Validator(CLI::ExistingDirectory).description(""));
}

Scene read_any_scene(const std::string& name, const std::vector<std::filesystem::path>& allowed_paths,
                     Messages& messages) {
    ReadOptions read;
    read.allowed_paths = allowed_paths;
    return read_scene(name, read, messages);
}

namespace {

void show_back_faces(Scene& scene, Messages& messages) {
    bool any_hidden = false;
    for (Material& material : scene.materials) any_hidden |= !std::exchange(material.double_sided, true);
    if (!any_hidden) messages.warn("--show-back-faces: no surface of the scene hides its back");
}

} // namespace

Scene load_scene(const SceneOptions& options, Messages& messages) {
    ReadOptions read;
    read.allowed_paths = options.allowed_paths;
    read.two_sided_lights = options.two_sided_lights;
    Scene scene = read_scene(options.scene, read, messages);
    if (options.two_sided_lights && std::ranges::none_of(scene.materials, &Material::is_emissive)) {
        messages.warn("--two-sided-lights: no surface of the scene gives light");
    }
    if (options.show_back_faces) show_back_faces(scene, messages);
    if (!options.environment.empty()) {
        scene.environment = environment_of(options, messages);
    }
    add_default_environment(scene, messages);
    if (scene.environment) {
        scene.environment->rotation += options.environment_rotation_deg * kRadiansPerDegree;
        scene.environment->scale = options.environment_scale * scene.environment->scale;
    } else {
        const auto warn = [&](const char* flag) {
            messages.warn(fmt::format("{}: the scene has no environment; --environment gives it one", flag));
        };
        if (options.environment_rotation_deg != 0) warn("--environment-rotation");
        if (options.environment_scale != 1) warn("--environment-scale");
    }
    return scene;
}

const Camera* scene_camera(const SceneOptions& options, const Scene& scene) {
    if (!options.camera.empty()) return &named_camera(options.camera, scene);
    return scene.cameras.empty() ? nullptr : &scene.cameras.front();
}

Camera choose_camera(const SceneOptions& said, const Scene& scene, float aspect, Messages& messages) {
    SceneOptions options = said;
    aim_eye(options, scene, messages);
    Camera camera;
    if (const Camera* given = scene_camera(options, scene)) {
        camera = *given;
    } else if (options.eye.empty()) {
        camera = make_camera(options, scene, aspect, messages);
    }
    place_camera(options, camera);
    if (options.fov_deg > 0) camera.fov_y = options.fov_deg * kRadiansPerDegree;
    if (options.aperture_m >= 0) camera.aperture_radius = options.aperture_m;
    if (options.focus_m > 0) camera.focus_distance = options.focus_m;
    if (options.projection == "perspective") camera.projection = Projection::Perspective;
    const bool flattened = options.projection == "orthographic" && camera.projection == Projection::Perspective;
    if (flattened) flatten(options, scene, camera);
    if (options.view_height_m > 0) camera.ortho_height = options.view_height_m;
    focus_in_the_middle(options, scene, camera, messages);
    warn_of_useless_flags(options, camera, flattened, messages);
    return camera;
}

} // namespace pertev
