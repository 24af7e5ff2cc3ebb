#include "session/check_integrator.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "denoise/oidn/oidn_library.h"
#include "device_scene/nest_solids.h"
#include "render/film_channels.h"
#include "render/lens_distortion.h"
#include "render/raster/pinhole.h"
#include "session/material_names.h"
#include "settings/check_settings.h"
#include "settings/value_names.h"
#include "shading/lobes/ggx.h"

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
/// Returns the kinds of light that the scene lacks, such as "no emitter, no point, spot or directional light, no
/// environment".
std::string no_lights_of(const Scene& scene) {
    return fmt::format("no emitter, no point, spot or directional light, {}",
                       scene.environment ? "and the environment is black" : "no environment");
}

void refuse(bool is_wrong, const char* setting, std::string_view value, std::string why) {
    if (is_wrong) throw Error(ErrorCode::BadInput, setting, std::string(value), std::move(why));
}

void give(const char* setting, PictureOptions& options) { options.given.emplace(setting, SettingOrigin::Caller); }

/// Returns the settings as options. Settings that differ from their defaults and have rules in the table count as
/// given.
PictureOptions options_of(const RenderSettings& settings) {
    PictureOptions options;
    options.render = settings;
    if (settings.is_denoised()) give("denoise", options);
    options.aovs = aov_names(settings.aovs);
    for (std::string& name : sample_layer_names(settings.sample_layers)) options.aovs.push_back(std::move(name));
    if (!options.aovs.empty()) give("aov", options);
    if (!options.aovs.empty() && settings.layers_at == LayersAt::Centre) give("layers_at", options);
    if (settings.light_paths) {
        options.lpe = light_layers_of(settings);
        options.lpe.resize(options.lpe.size() - settings.light_groups.size());
        options.light_groups = settings.light_groups;
        if (!options.lpe.empty()) give("lpe", options);
        if (!options.light_groups.empty()) give("light_group", options);
    }
    if (settings.irradiance) options.false_color = "illuminance", give("false_color", options);
    return options;
}

/// Returns whether there are surfaces to be lit but no lights that the integrator supports.
bool lacks_lights(const RenderSettings& settings, const Scene& scene) {
    const bool wants_lights = needs_punctual_lights(settings.integrator) && !settings.ambient;
    return wants_lights && settings.path.max_depth > 0 && !has_punctual_light(scene) && !is_all_unlit(scene);
}
bool has_own_ambient(const RenderSettings& settings, const Scene& scene) {
    return describe(settings.integrator).has_mean_ambient && scene.environment && emits_light(*scene.environment);
}

/// Returns what lights the scene has, such as "this scene has only emitters".
std::string lights_of(const Scene& scene) {
    const bool has_environment = scene.environment && emits_light(*scene.environment);
    const std::string others =
        fmt::format("{}{}{}", has_emitter(scene) ? "emitters" : "",
                    has_emitter(scene) && has_environment ? " and " : "", has_environment ? "an environment" : "");
    return others.empty() ? "this scene has none" : fmt::format("this scene has only {}", others);
}

/// Reports the materials of which light that is solved between diffuse surfaces leaves a part out.
void report_unsolved(const RenderSettings& settings, const Scene& scene, Sink& sink) {
    std::vector<bool> is_used(scene.materials.size());
    for (const Instance& instance : scene.instances) is_used[instance.material] = true;
    const auto report = [&](const char* what, const auto& has_part) {
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i < scene.materials.size(); ++i) {
            if (is_used[i] && has_part(scene.materials[i])) found.push_back(i);
        }
        if (found.empty()) return;
        sink.leave_out({"integrator", std::string(integrator_name(settings)),
                        fmt::format("it {}: {} (`integrator=path` does not)", what, names_of_materials(scene, found))});
    };
    const auto is_rough = [](const Material& m) { return m.roughness * m.roughness >= kSmoothAlpha; };
    report("leaves out the colour of coats", [](const Material& m) {
        const bool is_tinted = !(m.coat_color == Rgb{1, 1, 1}) || m.coat_color_texture.has_image();
        return !m.is_unlit() && m.has_coat() && is_tinted;
    });
    report("leaves out diffuse transmission", [](const Material& m) { return m.has_diffuse_transmission(); });
    report("renders rough metal black", [&](const Material& m) {
        const bool is_whole = m.kind == MaterialKind::MetallicRoughness && m.metallic == 1 && !is_black(m.base_color);
        return is_rough(m) && (m.kind == MaterialKind::Conductor || (is_whole && !m.metallic_texture.has_image()));
    });
    report("renders rough glass black", [&](const Material& m) {
        const bool is_pane = m.transmits() && m.transmission_weight == 1 && !m.transmission_texture.has_image();
        return is_rough(m) && ((m.kind == MaterialKind::Dielectric && m.ior != 1) || is_pane);
    });
}

} // namespace

void check_integrator(const RenderSettings& settings) {
    check_settings(options_of(settings), kRender);
    if (settings.path.max_depth > max_depth(settings.integrator)) {
        throw Error(ErrorCode::OverLimit, "max_depth", fmt::format("{}", settings.path.max_depth),
                    fmt::format("the limit with `integrator={}` is {}", integrator_name(settings),
                                max_depth(settings.integrator)));
    }
    describe(settings.integrator).check(settings);
    if (settings.denoise == Denoise::Oidn) OidnLibrary::find("denoise");
}

void check_shutter(const RenderSettings& settings) {
    PictureOptions options = options_of(settings);
    options.time_s = 0, options.shutter = "1";
    give("time", options), give("shutter", options);
    check_settings(options, kRender);
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
                        fmt::format("it renders a vacuum in place of media; {} know them",
                                    list_of(integrator_names(integrators_that(has_media))))});
    }
    if (describe(settings.integrator).is_solved) report_unsolved(settings, scene, sink);
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
