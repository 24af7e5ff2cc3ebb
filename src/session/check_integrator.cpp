#include "session/check_integrator.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"
#include "render/raster/pinhole.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

bool has_punctual_light(const Scene& scene) {
    return std::ranges::any_of(scene.lights, [](const Light& light) { return max_component(light.intensity) > 0; });
}
bool has_lamp(const Scene& scene) {
    return std::ranges::any_of(scene.instances,
                               [&](const Instance& instance) { return scene.materials[instance.material].is_lamp(); });
}
auto is_unlit_in(const Scene& scene) {
    return [&](const Instance& instance) { return scene.materials[instance.material].kind == MaterialKind::Unlit; };
}
bool is_all_unlit(const Scene& scene) { return std::ranges::all_of(scene.instances, is_unlit_in(scene)); }
/// Paths that find it take its colour on, though it is no light.
bool has_unlit(const Scene& scene) { return std::ranges::any_of(scene.instances, is_unlit_in(scene)); }
bool gives_light(const Environment& environment) {
    const Rgb scale = environment.scale;
    if (environment.image.pixels.empty()) return max_component(scale) > 0;
    const std::vector<float>& pixels = environment.image.pixels;
    for (std::size_t i = 0; i + 2 < pixels.size(); i += 3) {
        if (max_component(scale * Rgb{pixels[i], pixels[i + 1], pixels[i + 2]}) > 0) return true;
    }
    return false;
}
bool has_any_light(const Scene& scene) {
    return has_punctual_light(scene) || has_lamp(scene) || is_all_unlit(scene) ||
           (scene.environment && gives_light(*scene.environment));
}
/// "no lamp, no point, spot or directional light, no environment"
std::string no_lights_of(const Scene& scene) {
    return fmt::format("no lamp, no point, spot or directional light, {}",
                       scene.environment ? "and the environment is black" : "no environment");
}

void refuse_layers(bool is_wrong, const std::string& why) {
    if (is_wrong) throw Error(ErrorCode::BadInput, "--lpe: " + why);
}

/// Surfaces are to be lit, by lights that are not there.
bool lacks_lights(const RenderSettings& settings, const Scene& scene) {
    const bool wants_lights = needs_punctual_lights(settings.integrator) && !settings.ambient;
    return wants_lights && settings.path.max_depth > 0 && !has_punctual_light(scene) && !is_all_unlit(scene);
}
bool has_own_ambient(const RenderSettings& settings, const Scene& scene) {
    return needs_punctual_lights(settings.integrator) && settings.integrator != IntegratorKind::Cast &&
           scene.environment && gives_light(*scene.environment);
}

/// "this scene has lamps alone"
std::string lights_of(const Scene& scene) {
    const bool has_environment = scene.environment && gives_light(*scene.environment);
    const std::string others =
        fmt::format("{}{}{}", has_lamp(scene) ? "lamps" : "", has_lamp(scene) && has_environment ? " and " : "",
                    has_environment ? "an environment" : "");
    return others.empty() ? "this scene has none" : fmt::format("this scene has {} alone", others);
}

} // namespace

void check_integrator(const RenderSettings& settings) {
    const std::string_view name = integrator_name(settings);
    if (!makes_frames(settings.integrator) && settings.denoise != Denoise::None) {
        throw Error(ErrorCode::BadInput,
                    fmt::format("--denoise {}: reconstructs pictures of --integrator path and hybrid, not of {}",
                                name_of(settings.denoise), name));
    }
    if (settings.light_paths) {
        refuse_layers(
            !has_light_path_layers(settings.integrator),
            fmt::format("light paths are told apart by --integrator path, direct, indirect and hybrid, not by {}",
                        name));
        refuse_layers(settings.denoise != Denoise::None,
                      fmt::format("layers are means of samples, and --denoise {} makes one picture of them; leave out "
                                  "one of them",
                                  name_of(settings.denoise)));
    }
    if (settings.irradiance && (!has_light_path_layers(settings.integrator) || settings.denoise != Denoise::None)) {
        throw Error(
            ErrorCode::BadInput,
            fmt::format("--false-color illuminance: is found by --integrator path, direct, indirect and hybrid, "
                        "undenoised; not by {}{}",
                        name, settings.denoise != Denoise::None ? ", denoised" : ""));
    }
    if (settings.path.max_depth > most_depth(settings.integrator)) {
        throw Error(ErrorCode::OverLimit, fmt::format("--max-depth {}: with --integrator {} at most {}",
                                                      settings.path.max_depth, name, most_depth(settings.integrator)));
    }
    const PhotonMapSettings& photons = settings.photon_map;
    if (settings.integrator == IntegratorKind::PhotonMap &&
        !has_room_for_photons(photons.photons, settings.path.max_depth)) {
        throw Error(ErrorCode::OverLimit,
                    fmt::format("--photons {}: with --max-depth {} a pass may leave more than {} photons; at most {}",
                                photons.photons, settings.path.max_depth, kMostStored,
                                kMostStored / (2 * uint64_t(settings.path.max_depth - 1))));
    }
}

void check_shutter(const RenderSettings& settings) {
    if (!has_shutter(settings.integrator)) {
        throw Error(
            ErrorCode::BadInput,
            fmt::format("--shutter: rays have a time in --integrator path, direct, indirect, distributed, whitted "
                        "and cast, not in {}",
                        integrator_name(settings)));
    }
    if (settings.denoise == Denoise::None) return;
    throw Error(ErrorCode::BadInput,
                fmt::format("--shutter: --denoise {} takes what a pixel sees for one surface, which "
                            "it is not where something moves; leave out one of them",
                            name_of(settings.denoise)));
}

void check_camera(const RenderSettings& settings, const Camera& camera) {
    if (!rasterises_camera(settings.integrator)) return;
    const std::string why = why_no_raster(camera);
    if (why.empty()) return;
    throw Error(ErrorCode::BadInput, fmt::format("--integrator {}: {}", integrator_name(settings), why));
}

std::string why_dark(const RenderSettings& settings, const Scene& scene) {
    if (settings.integrator == IntegratorKind::PhotonMap && settings.path.max_depth > 0 && !has_any_light(scene)) {
        return fmt::format("--integrator {}: photons leave lights, and this scene has none: {}",
                           integrator_name(settings), no_lights_of(scene));
    }
    if (settings.integrator == IntegratorKind::Radiosity && !has_any_light(scene)) {
        return "radiosity: surfaces pass light on, and this scene has none: " + no_lights_of(scene);
    }
    if (!lacks_lights(settings, scene) || has_own_ambient(settings, scene)) return {};
    return fmt::format("--integrator {}: point, spot and directional lights alone light its surfaces, and {}: "
                       "--integrator distributed or path knows all lights, --ambient 0.5 lights all surfaces alike",
                       integrator_name(settings), lights_of(scene));
}

void check_light(const RenderSettings& settings, const Scene& scene, Messages& messages) {
    if (const std::string why = why_dark(settings, scene); !why.empty()) throw Error(ErrorCode::BadInput, why);
    const bool is_ambient = needs_punctual_lights(settings.integrator) && settings.ambient;
    if (!is_ambient && !has_any_light(scene) && !has_unlit(scene)) {
        messages.warn("nothing in this scene gives light: " + no_lights_of(scene) +
                      "; what light would have to show is black (--environment 1,1,1 gives some)");
        return;
    }
    if (!lacks_lights(settings, scene)) return;
    messages.note(
        fmt::format("--integrator {}: point, spot and directional lights light its surfaces, and {}; surfaces "
                    "show the environment's mean as ambient light (--integrator distributed casts shadows "
                    "of all lights)",
                    integrator_name(settings), lights_of(scene)));
}

} // namespace pertev
