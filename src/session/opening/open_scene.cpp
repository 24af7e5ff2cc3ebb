#include "session/opening/open_scene.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/message_text.h"
#include "device_scene/close_gaps.h"
#include "formats/files/file_choices.h"
#include "formats/read_environment.h"
#include "math/scalar.h"
#include "scene/names.h"
#include "session/degrees.h"
#include "session/opening/set_medium.h"
#include "session/opening/set_profiles.h"
#include "session/photometry.h"
#include "session/set_materials.h"
#include "session/survey/emitter_fronts.h"
#include "session/survey/ground.h"
#include "settings/parse_values.h"

namespace pertev {
namespace {

/// Returns the environment that the options set; nothing if they set none.
std::optional<Environment> environment_of(const SceneOptions& options, double efficacy, Sink& sink) {
    if (!options.sun_sky.empty()) return make_sun_sky(sun_sky(options), efficacy);
    Environment environment;
    if (Rgb color; parse_rgb(options.environment, color)) {
        if (!(is_finite(color) && color.r >= 0 && color.g >= 0 && color.b >= 0)) {
            throw Error(ErrorCode::BadInput, "environment", environment_text(options), "radiance cannot be negative");
        }
        environment.scale = color;
        return environment;
    }
    if (options.environment.empty()) return std::nullopt;
    if (std::error_code fault; !std::filesystem::exists(options.environment, fault)) {
        throw Error(ErrorCode::BadInput, "environment", options.environment,
                    "neither a file nor a radiance R,G,B such as 0.5,0.5,0.5");
    }
    environment.image = read_environment_image(options.environment, sink);
    return environment;
}

void turn_and_scale(const SceneOptions& options, Scene& scene, Sink& sink) {
    if (scene.environment) {
        scene.environment->rotation += options.environment_rotation_deg * kRadiansPerDegree;
        scene.environment->scale = options.environment_scale * scene.environment->scale;
        return;
    }
    const auto warn = [&](const char* setting) {
        sink.warn({setting, "", "the scene has no environment; set `environment`"});
    };
    if (options.environment_rotation_deg != 0) warn("environment_rotation");
    if (options.environment_scale != 1) warn("environment_scale");
}

/// Returns whether `emitter` names an emitter of the file, which is set before light is added. An environment is set
/// last, after scaling, and so are added lights.
bool names_emitter_of_file(const Scene& scene, const EmitterStrength& emitter) {
    if (scene.environment) return false;
    const auto is_called_so = [&](const auto& thing) { return has_name(names_of(scene, thing), emitter.name); };
    return std::ranges::any_of(scene.lights, is_called_so) ||
           std::ranges::any_of(scene.instances, [&](const Instance& instance) {
               return scene.materials[instance.material].is_emitter() && is_called_so(instance);
           });
}

void show_back_faces(Scene& scene, Sink& sink) {
    bool any_hidden = false;
    for (Material& material : scene.materials) any_hidden |= !std::exchange(material.double_sided, true);
    if (!any_hidden) sink.warn({"show_back_faces", "", "no surface of the scene has a hidden back"});
}

/// Returns whether a ground is added. `light` is the light that was added. `around` describes the scene if that is a
/// sky.
bool wants_ground(Ground ground, const Scene& scene, DefaultLight light, const Surroundings& around) {
    switch (ground) {
    case Ground::Off:
        return false;
    case Ground::On:
        return true;
    case Ground::Auto:
        return light == DefaultLight::Sky && scene.cameras.empty() && around.kind == SurroundingsKind::Object;
    }
    return false;
}

/// Joins the texts of a list for a message.
std::string in_a_row(const std::vector<std::string>& list) {
    constexpr std::size_t kMaxShown = 8;
    std::string text;
    for (std::size_t i = 0; i < std::min(list.size(), kMaxShown); ++i) text += (i > 0 ? ", " : "") + shortened(list[i]);
    return list.size() > kMaxShown ? fmt::format("{} and {} more", text, list.size() - kMaxShown) : text;
}

/// Adds a notice of the animation that plays if the file has several and none was chosen.
void report_animation(const Scene& scene, const std::string& file, Sink& sink) {
    if (scene.clips.size() < 2) return;
    const std::vector<std::string> clips = list_clips(scene.clips);
    sink.note({FileLocation{file}, fmt::format("the file has {} animations and plays the first, {}; `animation` "
                                               "(NAME, N or all) plays another or all of {}",
                                               clips.size(), shortened(clips.front()), in_a_row(clips))});
}

void report_file_scene(const Scene& scene, const std::string& file, Sink& sink) {
    if (scene.file_scenes.size() < 2) return;
    const std::vector<std::string> scenes = list_file_scenes(scene);
    sink.note({FileLocation{file},
               fmt::format("the file has {} scenes and shows {}; `file_scene` (NAME or N) shows another of {}",
                           scenes.size(), shortened(scenes[scene.file_scene]), in_a_row(scenes))});
}

void report_variants(const Scene& scene, const std::string& file, Sink& sink) {
    if (scene.variants.empty()) return;
    sink.note({FileLocation{file}, fmt::format("the file shows its default materials; `variant` (NAME or N) shows one "
                                               "of {}",
                                               in_a_row(list_material_variants(scene)))});
}

} // namespace

FileSpace file_space(const std::string& up_axis, const std::string& unit) {
    FileSpace space;
    if (!up_axis.empty()) {
        const std::optional<UpAxis> read = parse_up_axis(up_axis);
        if (!read) throw Error(ErrorCode::BadInput, "up_axis", up_axis, "expected x, y or z");
        space.up_axis = *read;
    }
    if (!unit.empty()) {
        const std::optional<double> read = parse_unit(unit);
        if (!read) {
            throw Error(ErrorCode::BadInput, "unit", unit,
                        fmt::format("expected {} or a number of metres above 0", kUnitNames));
        }
        space.unit_m = *read;
    }
    return space;
}

ReadOptions read_options(const SceneOptions& options) {
    ReadOptions read;
    read.allowed_paths = options.allowed_paths;
    read.two_sided_lights = options.two_sided_lights;
    read.space = file_space(options.up_axis, options.unit);
    read.animation = options.animation;
    read.file_scene = options.file_scene;
    read.variant = options.variant;
    read.max_texture_size = options.max_texture_size;
    read.defines = options.defines;
    return read;
}

SunSky sun_sky(const SceneOptions& options) {
    if (const auto sky = parse_sun_sky(options.sun_sky)) return *sky;
    throw Error(ErrorCode::BadInput, "sun_sky", options.sun_sky,
                "expected ELEVATION,AZIMUTH[,TURBIDITY]: 0 to 90 degrees, degrees, and 2 to 10, as in 45,90,3");
}

std::string environment_text(const SceneOptions& options) {
    Rgb radiance;
    if (!parse_rgb(options.environment, radiance)) return options.environment;
    return fmt::format("{},{},{}", radiance.r, radiance.g, radiance.b);
}

Scene read_scene_and_emitters(const std::filesystem::path& path, const ReadOptions& options, Sink& sink) {
    Scene scene = read_scene(path, options, sink);
    if (options.file_scene.empty()) report_file_scene(scene, path.string(), sink);
    if (options.variant.empty()) report_variants(scene, path.string(), sink);
    if (!(options.space == FileSpace()) && defines_space(path)) {
        sink.warn({FileLocation{path.string()},
                   "the file is in metres with y up; `up_axis` and `unit` are for .obj, .ply and .stl"});
    }
    if (!options.two_sided_lights && !defines_emitter_sides(path)) report_emitter_fronts(scene, path.string(), sink);
    return scene;
}

void change_materials(const SceneOptions& options, Scene& scene, Sink& sink) {
    std::vector<MaterialChange> changes;
    for (const std::string& text : options.materials) changes.push_back(parse_material_change(text));
    set_materials(scene, changes, sink, lumens_per_watt(options.scene, static_cast<double>(options.efficacy)));
}

Scene open_scene(const SceneOptions& options, Sink& sink, SceneUse use, Ground ground, const ReadScene& read) {
    std::vector<EmitterStrength> emitters;
    for (const std::string& text : options.emitters) emitters.push_back(parse_emitter(text));
    Scene scene = read ? read(sink) : read_scene_and_emitters(options.scene, read_options(options), sink);
    change_materials(options, scene, sink);
    if (const uint32_t count = close_gaps(scene); count > 0) {
        sink.note(fmt::format("{} of glass or water {} another one and {} by {} of its size, so that no air is between",
                              count == 1 ? "a solid" : fmt::format("{} solids", count),
                              count == 1 ? "touches" : "touch", count == 1 ? "grows" : "grow", 2 * kTouching));
    }
    if (options.animation.empty()) report_animation(scene, options.scene, sink);
    if (options.two_sided_lights && std::ranges::none_of(scene.materials, &Material::is_emissive)) {
        sink.warn({"two_sided_lights", "", "no surface of the scene emits light"});
    }
    if (options.show_back_faces) show_back_faces(scene, sink);
    const double efficacy = lumens_per_watt(options.scene, static_cast<double>(options.efficacy));
    if (auto environment = environment_of(options, efficacy, sink)) scene.environment = *std::move(environment);
    set_profiles(scene, options.profiles, efficacy, sink);
    const bool has_light = !lacks_light(scene);
    const auto others = std::ranges::stable_partition(
        emitters, [&](const EmitterStrength& emitter) { return names_emitter_of_file(scene, emitter); });
    set_emitters(scene, {emitters.begin(), others.begin()}, efficacy);
    Surroundings around;
    // Someone who switches off the last light of a file wants it dark.
    const bool is_turned_off = has_light && lacks_light(scene);
    const DefaultLight light = is_turned_off ? DefaultLight::None : add_default_light(scene, use, sink, &around);
    if (wants_ground(ground, scene, light, around)) {
        add_ground(scene);
        sink.make_up("a default ground receives the shadow; set `ground=off` to leave it out");
    }
    turn_and_scale(options, scene, sink);
    set_emitters(scene, others, efficacy);
    set_medium(options.medium, scene, sink);
    return scene;
}

Scene open_scene(const std::string& scene, Sink& sink, SceneUse use) {
    SceneOptions options; // a temporary makes g++ 12 warn of unset members
    options.scene = scene;
    return open_scene(options, sink, use);
}

} // namespace pertev
