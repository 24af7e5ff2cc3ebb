#include "session/check_integrator.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"
#include "session/settings_text.h"

namespace pertev {
namespace {

bool has_punctual_light(const Scene& scene) {
    return std::ranges::any_of(scene.lights, [](const Light& light) { return max_component(light.intensity) > 0; });
}
bool has_lamp(const Scene& scene) {
    return std::ranges::any_of(scene.instances,
                               [&](const Instance& instance) { return scene.materials[instance.material].is_lamp(); });
}
bool is_all_unlit(const Scene& scene) {
    return std::ranges::all_of(scene.instances, [&](const Instance& instance) {
        return scene.materials[instance.material].kind == MaterialKind::Unlit;
    });
}

} // namespace

void check_integrator(const RenderSettings& settings) {
    const std::string_view name = integrator_name(settings);
    if (!makes_frames(settings.integrator) && settings.denoise != Denoise::None) {
        throw Error(ErrorCode::BadInput,
                    fmt::format("--denoise {}: reconstructs pictures of --integrator path, not of {}",
                                name_of(settings.denoise), name));
    }
    if (settings.path.max_depth > most_depth(settings.integrator)) {
        throw Error(ErrorCode::OverLimit, fmt::format("--max-depth {}: with --integrator {} at most {}",
                                                      settings.path.max_depth, name, most_depth(settings.integrator)));
    }
}

void check_light(const RenderSettings& settings, const Scene& scene, Messages& messages) {
    if (!needs_punctual_lights(settings.integrator) || settings.ambient || has_punctual_light(scene)) return;
    if (settings.path.max_depth == 0 || is_all_unlit(scene)) return;
    const std::string_view name = integrator_name(settings);
    const std::string others =
        fmt::format("{}{}{}", has_lamp(scene) ? "lamps" : "", has_lamp(scene) && scene.environment ? " and " : "",
                    scene.environment ? "an environment" : "");
    const std::string has = others.empty() ? "this scene has none" : fmt::format("this scene has {} alone", others);
    if (settings.integrator == IntegratorKind::Whitted && scene.environment) {
        messages.note(fmt::format("--integrator {}: point, spot and directional lights cast its shadows, and {}; "
                                  "surfaces show the environment's mean as ambient light (--integrator distributed "
                                  "casts shadows of all lights)",
                                  name, has));
        return;
    }
    throw Error(
        ErrorCode::BadInput,
        fmt::format("--integrator {}: point, spot and directional lights alone light its surfaces, and {}: "
                    "--integrator distributed or path knows all lights, --ambient 0.5 lights all surfaces alike",
                    name, has));
}

} // namespace pertev
