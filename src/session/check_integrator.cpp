#include "session/check_integrator.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "denoise/oidn/oidn_library.h"
#include "device_scene/nest_solids.h"
#include "render/lens_distortion.h"
#include "render/raster/pinhole.h"
#include "settings/value_names.h"

namespace pertev {
namespace {

bool has_punctual_light(const Scene& scene) {
    return std::ranges::any_of(scene.lights, [](const Light& light) { return max_component(light.intensity) > 0; });
}
bool has_emitter(const Scene& scene) {
    return std::ranges::any_of(
        scene.instances, [&](const Instance& instance) { return scene.materials[instance.material].is_emitter(); });
}
auto is_unlit_in(const Scene& scene) {
    return [&](const Instance& instance) { return scene.materials[instance.material].is_unlit(); };
}
bool is_all_unlit(const Scene& scene) { return std::ranges::all_of(scene.instances, is_unlit_in(scene)); }
/// Returns whether the scene has unlit surfaces. Paths carry their colour on, though they are no lights.
bool has_unlit(const Scene& scene) { return std::ranges::any_of(scene.instances, is_unlit_in(scene)); }
bool emits_light(const Environment& environment) {
    const Rgb scale = environment.scale;
    if (environment.image.pixels.empty()) return max_component(scale) > 0;
    const std::vector<float>& pixels = environment.image.pixels;
    for (std::size_t i = 0; i + 2 < pixels.size(); i += 3) {
        if (max_component(scale * Rgb{pixels[i], pixels[i + 1], pixels[i + 2]}) > 0) return true;
    }
    return false;
}
bool has_any_light(const Scene& scene) {
    return has_punctual_light(scene) || has_emitter(scene) || is_all_unlit(scene) ||
           (scene.environment && emits_light(*scene.environment));
}
/// A list such as "no emitter, no point, spot or directional light, no environment".
std::string no_lights_of(const Scene& scene) {
    return fmt::format("no emitter, no point, spot or directional light, {}",
                       scene.environment ? "and the environment is black" : "no environment");
}

void refuse(bool is_wrong, const char* setting, std::string_view value, std::string why) {
    if (is_wrong) throw Error(ErrorCode::BadInput, setting, std::string(value), std::move(why));
}

std::string those_that(bool (*has)(IntegratorKind)) { return list_of(integrator_names(integrators_that(has))); }

/// Returns whether there are surfaces to be lit but no lights that the integrator supports.
bool lacks_lights(const RenderSettings& settings, const Scene& scene) {
    const bool wants_lights = needs_punctual_lights(settings.integrator) && !settings.ambient;
    return wants_lights && settings.path.max_depth > 0 && !has_punctual_light(scene) && !is_all_unlit(scene);
}
bool has_own_ambient(const RenderSettings& settings, const Scene& scene) {
    return describe(settings.integrator).has_mean_ambient && scene.environment && emits_light(*scene.environment);
}

/// A phrase such as "this scene has only emitters".
std::string lights_of(const Scene& scene) {
    const bool has_environment = scene.environment && emits_light(*scene.environment);
    const std::string others =
        fmt::format("{}{}{}", has_emitter(scene) ? "emitters" : "",
                    has_emitter(scene) && has_environment ? " and " : "", has_environment ? "an environment" : "");
    return others.empty() ? "this scene has none" : fmt::format("this scene has only {}", others);
}

} // namespace

void check_integrator(const RenderSettings& settings) {
    const std::string_view name = integrator_name(settings);
    const bool is_denoised = settings.denoise != Denoise::None;
    refuse(is_denoised && !makes_frames(settings.integrator), "denoise", name_of(settings.denoise),
           fmt::format("supports {}, not {}", those_that(makes_frames), name));
    refuse(is_denoised && (settings.sample_layers & kLayerVariance) != 0, "aov", "variance",
           fmt::format("`denoise={}` does not keep samples apart; leave out one of them", name_of(settings.denoise)));
    const bool takes_samples = (settings.sample_layers & (kLayerUv | kLayerObjects | kLayerMaterials)) != 0;
    refuse(takes_samples && settings.layers_at == LayersAt::Centre, "layers_at", "centre",
           "the layers uv, crypto_object and crypto_material are of the samples");
    refuse(is_denoised && (settings.aovs & kAovDistance) != 0, "aov", "distance",
           fmt::format("`denoise={}` does not support it; its depth is measured along the axis",
                       name_of(settings.denoise)));
    if (settings.light_paths) {
        refuse(!has_light_path_layers(settings.integrator), "lpe", "",
               fmt::format("{} distinguish light paths, {} does not", those_that(has_light_path_layers), name));
        refuse(is_denoised, "lpe", "",
               fmt::format("layers are means of samples, which `denoise={}` does not keep; leave out one of them",
                           name_of(settings.denoise)));
    }
    refuse(settings.irradiance && (is_denoised || !has_light_path_layers(settings.integrator)), "false_color",
           "illuminance",
           fmt::format("only {} without denoising compute it, not {}{}", those_that(has_light_path_layers), name,
                       is_denoised ? ", denoised" : ""));
    if (settings.path.max_depth > max_depth(settings.integrator)) {
        throw Error(ErrorCode::OverLimit, "max_depth", fmt::format("{}", settings.path.max_depth),
                    fmt::format("the limit with `integrator={}` is {}", name, max_depth(settings.integrator)));
    }
    describe(settings.integrator).check(settings);
    if (settings.denoise == Denoise::Oidn) OidnLibrary::find("denoise");
}

void check_shutter(const RenderSettings& settings) {
    refuse(!has_shutter(settings.integrator), "shutter", "",
           fmt::format("{} support motion blur, {} does not", those_that(has_shutter), integrator_name(settings)));
    refuse(settings.denoise != Denoise::None, "shutter", "",
           fmt::format("`denoise={}` needs one surface per pixel, and motion blur shows several; leave out one of them",
                       name_of(settings.denoise)));
}

void check_camera(const RenderSettings& settings, const Camera& camera) {
    refuse(settings.denoise == Denoise::Svgf && sees_behind(camera.lens), "lens", name_of(camera.lens),
           "`denoise=svgf` needs a lens that sees less than half of all directions (`denoise=oidn` supports it)");
    if (!rasterises_camera(settings.integrator)) return;
    const std::string why = why_no_raster(camera);
    refuse(!why.empty(), "integrator", integrator_name(settings), why);
}

void check_panorama(const RenderSettings& settings, const Camera& camera) {
    refuse(camera.lens == LensModel::Cube && settings.width != 6 * settings.height, "size",
           fmt::format("{}x{}", settings.width, settings.height),
           "`lens=cube` has six square faces in a row, such as 3072x512");
}

void check_reconstruction(const Camera& camera) {
    refuse(!has_straight_lens(camera), "distortion", "", "real-time frames need a lens without distortion");
}

void check_media(const RenderSettings& settings) {
    refuse(settings.irradiance && has_media(settings.integrator), "false_color", "illuminance",
           "it does not support scenes with media (`medium`, or that of a material)");
}

std::optional<Remark> why_dark(const RenderSettings& settings, const Scene& scene) {
    const auto why = [&](std::string text) {
        return Remark("integrator", std::string(integrator_name(settings)), std::move(text));
    };
    const IntegratorDescriptor& kind = describe(settings.integrator);
    if (kind.needs_any_light && (kind.is_solved || settings.path.max_depth > 0) && !has_any_light(scene)) {
        std::string text = fmt::format("{} needs light, and this scene has none: {}", kind.name, no_lights_of(scene));
        return kind.is_solved ? Remark(std::move(text)) : why(std::move(text)); // solving has no such setting
    }
    if (!lacks_lights(settings, scene) || has_own_ambient(settings, scene)) return {};
    return why(
        fmt::format("only point, spot and directional lights light its surfaces, and {}; `integrator=distributed` "
                    "and path support all lights, and `ambient=0.5` lights all surfaces equally",
                    lights_of(scene)));
}

void check_light(const RenderSettings& settings, const Scene& scene, Sink& sink) {
    const bool nests =
        !describe(settings.integrator).ignores_nesting || // integrators that know media follow solids in them
        (has_media(scene) && has_media(settings.integrator));
    if (!nests && NestedSolids(scene, {}).is_nested()) {
        sink.leave_out({"integrator", std::string(integrator_name(settings)),
                        "solids lie in each other, and it refracts at each as in a vacuum (`integrator=path`, "
                        "whitted and distributed do not)"});
    }
    if (has_media(scene) && !has_media(settings.integrator)) {
        sink.leave_out({"integrator", std::string(integrator_name(settings)),
                        fmt::format("it renders a vacuum in place of media; {} know them", those_that(has_media))});
    }
    if (has_media(scene)) check_media(settings);
    if (const auto why = why_dark(settings, scene)) throw Error(ErrorCode::BadInput, *why);
    const bool is_ambient = needs_punctual_lights(settings.integrator) && settings.ambient;
    if (!is_ambient && !has_any_light(scene) && !has_unlit(scene)) {
        sink.warn("nothing in this scene emits light: " + no_lights_of(scene) +
                  "; the picture would be black (`environment=1,1,1` adds light)");
        return;
    }
    if (!lacks_lights(settings, scene)) return;
    sink.note({"integrator", std::string(integrator_name(settings)),
               fmt::format("point, spot and directional lights light its surfaces, and {}; surfaces show the "
                           "environment's mean as ambient light (`integrator=distributed` casts shadows of all "
                           "lights)",
                           lights_of(scene))});
}

} // namespace pertev
