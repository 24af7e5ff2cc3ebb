#include "apps/cli/scene_options.h"

#include <charconv>
#include <optional>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "apps/cli/parse_values.h"
#include "base/error.h"
#include "formats/builtin_scenes.h"
#include "formats/read_scene.h"
#include "formats/read_environment.h"
#include "scene/defaults.h"

namespace pertev {
namespace {

constexpr float kRadiansPerDegree = kPi / 180.0f;

Environment environment_of(const SceneOptions& options, Messages& messages) {
    Environment environment;
    environment.rotation = options.environment_rotation_deg * kRadiansPerDegree;
    environment.scale = grey(options.environment_scale);
    if (Rgb color; parse_rgb(options.environment, color)) {
        if (color.r < 0 || color.g < 0 || color.b < 0) {
            throw Error(ErrorCode::BadInput,
                        fmt::format("--environment {}: radiance cannot be negative", options.environment));
        }
        environment.scale = options.environment_scale * color;
        return environment;
    }
    environment.image = read_environment_image(options.environment, messages);
    return environment;
}

/// The scene's camera of that name or number (from 0).
const Camera& named_camera(const std::string& name, const Scene& scene) {
    for (const Camera& camera : scene.cameras) {
        if (camera.name == name) return camera;
    }
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (error == std::errc() && end == name.data() + name.size() && number < scene.cameras.size()) {
        return scene.cameras[number];
    }
    std::string known;
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
        known += fmt::format("\n  {}  {}", i, scene.cameras[i].name);
    }
    throw Error(ErrorCode::BadInput, fmt::format("--camera {}: the scene has no such camera; it has:{}", name,
                                                 known.empty() ? "\n  none" : known));
}

void place_camera(const SceneOptions& options, Camera& camera) {
    if (options.eye.empty() && options.target.empty() && options.up.empty()) return;
    const Transform& from = camera.world_from_camera;
    const Vec3 eye = options.eye.empty() ? from.translation : parse_vec3("--eye", options.eye);
    const Vec3 target = options.target.empty() ? eye - column(from, 2) : parse_vec3("--target", options.target);
    const Vec3 up = options.up.empty() ? Vec3{0, 1, 0} : parse_vec3("--up", options.up);
    Transform placed = look_at(eye, target, up);
    if (!is_finite(placed.row0) && options.up.empty()) placed = look_at(eye, target, {0, 0, -1}); // straight down or up
    if (!is_finite(placed.row0) || !is_finite(placed.row1) || !is_finite(placed.row2)) {
        throw Error(ErrorCode::BadInput,
                    fmt::format("--eye {},{},{} --target {},{},{} --up {},{},{}: the target must differ from the eye and "
                                "not lie along up",
                                eye.x, eye.y, eye.z, target.x, target.y, target.z, up.x, up.y, up.z));
    }
    camera.world_from_camera = placed;
    if (options.focus_m <= 0) camera.focus_distance = length(target - eye);
}

} // namespace

void add_scene_options(CLI::App& verb, SceneOptions& options) {
    verb.add_option("SCENE", options.scene, "a .gltf, .glb, .obj or .ply file, or a built-in scene: cornell-box")
        ->required();
    const char* group = "Camera";
    verb.add_option("--camera", options.camera, "the scene's camera of this name or number")->group(group);
    verb.add_option("--eye", options.eye, "X,Y,Z: where the camera is, metres")->group(group);
    verb.add_option("--target", options.target, "X,Y,Z: what it looks at")->group(group);
    verb.add_option("--up", options.up, "X,Y,Z: upwards (0,1,0)")->group(group);
    verb.add_option("--fov", options.fov_deg, "full vertical angle of view, degrees")
        ->check(CLI::Range(0.01, 179.0))->group(group);
    verb.add_option("--projection", options.projection, "perspective or orthographic")
        ->check(CLI::IsMember({"perspective", "orthographic"}))->group(group);
    verb.add_option("--view-height", options.view_height_m, "orthographic: full height of the view, metres")
        ->check(CLI::PositiveNumber)->group(group);
    verb.add_option("--aperture", options.aperture_m, "radius of the lens, metres; 0: everything is sharp")
        ->check(CLI::NonNegativeNumber)->group(group);
    verb.add_option("--focus", options.focus_m, "distance in focus, metres (that of the target)")
        ->check(CLI::PositiveNumber)->group(group);
    group = "Environment";
    verb.add_option("--environment", options.environment, "an .hdr or .exr panorama, or R,G,B: light from far away")
        ->group(group);
    verb.add_option("--environment-rotation", options.environment_rotation_deg, "degrees about +y")->group(group);
    verb.add_option("--environment-scale", options.environment_scale, "times its radiance")
        ->check(CLI::NonNegativeNumber)->group(group);
    verb.add_option("--allow-path", options.allowed_paths, "a folder outside the scene's own that it may read from")
        ->check(CLI::ExistingDirectory);
}

LoadedScene load_scene(const SceneOptions& options, Messages& messages) {
    ReadOptions read;
    read.allowed_paths = options.allowed_paths;
    Scene scene = builtin_scene(options.scene) ? read_builtin_scene(options.scene, messages)
                                               : read_scene(options.scene, read, messages);
    if (!options.environment.empty()) {
        scene.environment = environment_of(options, messages);
    } else if (scene.environment) {
        scene.environment->rotation += options.environment_rotation_deg * kRadiansPerDegree;
        scene.environment->scale = options.environment_scale * scene.environment->scale;
    }
    const bool had_environment = scene.environment.has_value();
    const std::size_t lights = scene.lights.size();
    add_default_environment(scene, messages);
    const bool default_light = scene.lights.size() != lights || scene.environment.has_value() != had_environment;
    return {std::move(scene), default_light};
}

Camera choose_camera(const SceneOptions& options, const Scene& scene, uint32_t width, uint32_t height,
                     Messages& messages) {
    Camera camera;
    const bool placed = !options.eye.empty() && !options.target.empty();
    if (!options.camera.empty()) {
        camera = named_camera(options.camera, scene);
    } else if (!scene.cameras.empty()) {
        camera = scene.cameras.front();
    } else if (!placed) {
        camera = make_default_camera(scene, static_cast<float>(width) / static_cast<float>(height), messages);
    }
    place_camera(options, camera);
    if (options.fov_deg > 0) camera.fov_y = options.fov_deg * kRadiansPerDegree;
    if (options.aperture_m >= 0) camera.aperture_radius = options.aperture_m;
    if (options.focus_m > 0) camera.focus_distance = options.focus_m;
    if (options.projection == "perspective") camera.projection = Projection::Perspective;
    if (options.projection == "orthographic") camera.projection = Projection::Orthographic;
    if (options.view_height_m > 0) camera.ortho_height = options.view_height_m;
    return camera;
}

} // namespace pertev
