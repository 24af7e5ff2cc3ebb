#include "apps/cli/render_flags.h"

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/cli/flag_checks.h"
#include "apps/cli/parse_values.h"
#include "apps/cli/real_time_flags.h"
#include "base/error.h"
#include "base/limits.h"
#include "image/write_exr.h"
#include "image/write_image.h"
#include "session/check_integrator.h"
#include "session/height_maps.h"
#include "session/settings_text.h"

namespace pertev {
namespace {

bool keeps_alpha(const std::string& output) {
    const ImageFormat format = image_format_for(output);
    return format == ImageFormat::Exr || format == ImageFormat::Png;
}

bool writes_any(const RenderFlags& flags, std::initializer_list<ImageFormat> formats) {
    return std::ranges::any_of(flags.outputs, [&](const std::string& output) {
        return std::ranges::find(formats, image_format_for(output)) != formats.end();
    });
}

bool is_picture(const std::string& name) {
    try {
        image_format_for(name);
        return true;
    } catch (const Error&) {
        return false;
    }
}

/// "a.png,b.exr" is one file's name, which hardly anybody means. Throws Error(BadInput).
void refuse_list(const std::string& output) {
    const std::size_t comma = output.find(',');
    if (comma == std::string::npos || !is_picture(output.substr(0, comma))) return;
    std::string each = output;
    for (std::size_t at = 0; (at = each.find(',', at)) != std::string::npos; at += 4) each.replace(at, 1, " -o ");
    throw Error(
        ErrorCode::BadInput,
        fmt::format("-o {}: this is the name of one file; each picture has a -o of its own: -o {}", output, each));
}

/// The file that is written, however it is named: without links, also one to a file that is not there yet, "." and
/// "..".
std::filesystem::path place_of(const std::string& file) {
    constexpr int kMostLinks = 40; // as many as Linux follows
    std::error_code fault;         // then the place as far as it is known
    std::filesystem::path place = std::filesystem::absolute(file, fault);
    for (int i = 0; i < kMostLinks && std::filesystem::is_symlink(place, fault); ++i) {
        place = place.parent_path() / std::filesystem::read_symlink(place, fault);
    }
    const std::filesystem::path known = std::filesystem::weakly_canonical(place, fault);
    return fault ? place : known;
}

/// Throws Error(BadInput) where two outputs are one file, of which the second picture would replace the first; of a
/// sequence, where they are at some frame.
void refuse_twins(const std::vector<std::string>& outputs, const std::optional<FrameSequence>& frames) {
    std::map<std::filesystem::path, std::string> taken;
    for (const std::string& output : outputs) {
        const std::string file = frames ? frame_file(output, frames->last) : output; // the most digits
        const auto [place, is_new] = taken.emplace(place_of(file), output);
        if (is_new) continue;
        throw Error(ErrorCode::BadInput,
                    fmt::format("-o {}: -o {} names the same file{}; leave out one of them", output, place->second,
                                frames ? fmt::format(" for frame {}", frames->last) : ""));
    }
}

/// Names that the picture's own channels and other layers have in files.
bool is_layer_of_files(const std::string& name) {
    return name == "noisy" ||
           std::ranges::any_of(kAovTable, [&](const AovGroup& group) { return name == group.layer; });
}

/// One thing leads the camera.
void check_camera_path(const RenderFlags& flags) {
    if (flags.camera_path.empty()) return;
    const SceneOptions& scene = flags.scene;
    for (const auto& [flag, text] :
         {std::pair("--eye", &scene.eye), std::pair("--target", &scene.target), std::pair("--up", &scene.up)}) {
        refuse(!text->empty(), fmt::format("{}: the camera's path says it; leave out one of them", flag));
    }
    refuse(flags.turntable > 0, "--turntable: the camera goes its path; leave out one of them");
}

/// Without a scene: what can be told of them before it is read.
LightPathLayers light_paths(const RenderFlags& flags) {
    LightPathLayers layers;
    for (const std::string& text : flags.light_paths) layers.expressions.push_back(parse_light_path(text));
    check_layers(layers.expressions);
    for (const LightPathExpression& expression : layers.expressions) {
        refuse(is_layer_of_files(expression.name),
               fmt::format("--lpe {}: files have another layer of this name", expression.name));
    }
    return layers;
}

/// The ends of a scale. Throws Error(BadInput).
std::pair<float, float> parse_range(const std::string& text) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const float least = number_in(text.substr(0, comma)).value_or(0.0f);
    const float most = number_in(text.substr(std::min(comma + 1, text.size()))).value_or(0.0f);
    refuse(!(least > 0 && least < most),
           fmt::format("--false-color-range {}: expected A,B with 0 < A < B, as 1,1000", text));
    return {least, most};
}

/// What can be told of exposure and false colours.
void check_display_flags(const RenderFlags& flags) {
    physical_exposure(flags);
    if (!flags.false_color_range.empty()) parse_range(flags.false_color_range);
    refuse(!flags.false_color_range.empty() && flags.false_color.empty(),
           "--false-color-range: of --false-color luminance or illuminance");
    const bool shows_tones = !flags.exposure.empty() || !flags.tone_map.empty() || flags.f_number > 0;
    refuse(!flags.false_color.empty() && shows_tones,
           "--false-color: numbers have a scale, --false-color-range, and no exposure or tones; leave out one of them");
    refuse(!flags.false_color.empty() && flags.transparent, "--false-color: its picture has no alpha; leave out "
                                                            "--transparent");
}

std::vector<HeightMapText> height_maps(const RenderFlags& flags) {
    std::vector<HeightMapText> maps;
    for (const std::string& text : flags.displacements) maps.push_back(parse_height_map(text));
    return maps;
}

/// All settings but the size. Throws Error where they do not go together.
RenderSettings light_settings(const RenderFlags& flags) {
    RenderSettings settings; // CLI11 has checked all names
    settings.samples = flags.samples;
    settings.filter = *filter_named(flags.filter);
    settings.filter_radius = flags.filter_radius;
    settings.transparent = flags.transparent;
    settings.denoise = *denoise_named(flags.denoise);
    settings.time_limit_s = flags.time_limit_s;
    for (const std::string& name : flags.aovs) settings.aovs |= *aov_named(name);
    settings.irradiance = flags.false_color == "illuminance";
    if (!flags.light_paths.empty()) settings.light_paths = std::make_shared<const LightPathLayers>(light_paths(flags));
    settings.path = {.max_depth = flags.max_depth,
                     .clamp = flags.clamp,
                     .sampler = *sampler_named(flags.sampler),
                     .seed = flags.seed};
    if (!flags.ambient.empty()) settings.ambient = parse_radiance("--ambient", flags.ambient);
    if (!flags.shading.empty()) settings.look.shading = *shading_named(flags.shading);
    settings.look.is_wireframe = flags.wireframe;
    set_integrator(settings, flags.integrator);
    settings.photon_map = photon_map_settings(flags.photons, settings.integrator, flags.integrator);
    settings.irradiance_cache = irradiance_cache_settings(flags.cache, settings.integrator, flags.integrator);
    check_radiosity_flags(flags.radiosity, settings.integrator, flags.integrator, flags.limits_memory);
    check_integrator(settings);
    if (flags.shading_rate > 0) settings.shading_rate = flags.shading_rate;
    height_maps(flags);
    const bool is_reyes = settings.integrator == IntegratorKind::Reyes;
    refuse(flags.shading_rate > 0 && !is_reyes, "--shading-rate: of --integrator reyes");
    refuse(!flags.displacements.empty() && !is_reyes,
           fmt::format("--displacement: --integrator reyes alone displaces surfaces, {} does not", flags.integrator));
    const bool is_raster = settings.integrator == IntegratorKind::Raster;
    refuse(!flags.shading.empty() && !is_raster,
           fmt::format("--shading: of --integrator raster; {} shades every sample", flags.integrator));
    refuse(flags.wireframe && !is_raster, "--wireframe: of --integrator raster");
    refuse(flags.wireframe && !flags.shading.empty(), "--shading: with --wireframe nothing is shaded");
    refuse(settings.ambient && !needs_punctual_lights(settings.integrator),
           fmt::format("--ambient: a light of --integrator cast, whitted, raster and reyes; {} finds what comes from "
                       "all around itself",
                       flags.integrator));
    refuse(settings.path.clamp > 0 && !makes_frames(settings.integrator),
           fmt::format("--clamp: of --integrator path and hybrid, not of {}", flags.integrator));
    return settings;
}

/// Throws Error(BadInput) that names what is missing.
void refuse_half_exposure(const RenderFlags& flags) {
    if (flags.f_number > 0 && flags.shutter_s > 0) return;
    const char* missing = flags.f_number > 0    ? "--shutter-time SECONDS, how long the shutter is open"
                          : flags.shutter_s > 0 ? "--f-number N, of the lens"
                                                : "--f-number N, of the lens, and --shutter-time SECONDS";
    const char* given = flags.f_number > 0 ? "--f-number" : flags.shutter_s > 0 ? "--shutter-time" : "--iso";
    throw Error(ErrorCode::BadInput, fmt::format("{}: a physical exposure takes {}, too", given, missing));
}

} // namespace

std::optional<PhysicalExposure> physical_exposure(const RenderFlags& flags) {
    if (!(flags.iso > 0 || flags.f_number > 0 || flags.shutter_s > 0)) return std::nullopt;
    refuse_half_exposure(flags);
    refuse(!flags.exposure.empty(), "--exposure: --f-number and --shutter-time say it; leave out one of them");
    PhysicalExposure exposure;
    if (flags.iso > 0) exposure.iso = static_cast<double>(flags.iso);
    exposure.f_number = static_cast<double>(flags.f_number);
    exposure.shutter_s = static_cast<double>(flags.shutter_s);
    return exposure;
}

std::optional<FalseColors> false_colors(const RenderFlags& flags) {
    if (flags.false_color.empty()) return std::nullopt;
    FalseColors colors;
    colors.quantity = flags.false_color;
    colors.unit = flags.false_color == "illuminance" ? "lx" : "cd/m2";
    colors.factor = static_cast<float>(efficacy_of(flags.scene));
    if (!flags.false_color_range.empty()) std::tie(colors.least, colors.most) = parse_range(flags.false_color_range);
    return colors;
}

void add_light_path_flags(CLI::App& verb, RenderFlags& flags, const char* group) {
    verb.add_option("--spp", flags.samples, "samples a pixel")
        ->type_name("N")
        ->check(whole_between(1, kMaxSamplesPerPixel))
        ->capture_default_str()
        ->group(group);
    verb.add_option("--integrator", flags.integrator,
                    "path, or its parts direct and indirect; hybrid, cast,\nwhitted, distributed, raster, reyes; "
                    "light, bidirectional,\nphoton_map, irradiance_cache, radiosity (docs/transport.md)")
        ->type_name("NAME")
        ->check(one_of(integrator_names()))
        ->capture_default_str()
        ->group(group);
    verb.add_option("--max-depth", flags.max_depth,
                    "most scatterings of a path, and levels of a tree of rays:\n0 emission, 1 direct light")
        ->type_name("N")
        ->check(whole_between(0, kMaxPathDepth - 1))
        ->capture_default_str()
        ->group(group);
    verb.add_option(
            "--ambient", flags.ambient,
            "of cast, whitted, raster and reyes: radiance from all around\nthat diffuse surfaces reflect (cast 0, "
            "the others the\nenvironment's mean)")
        ->type_name("R,G,B")
        ->group(group);
    verb.add_option("--shading", flags.shading,
                    "of raster: light once a triangle, at its corners, or in\nevery pixel (phong)")
        ->type_name("NAME")
        ->check(one_of(shading_names()))
        ->group(group);
    verb.add_flag("--wireframe", flags.wireframe, "of raster: the triangles' edges alone")->group(group);
    verb.add_option("--shading-rate", flags.shading_rate,
                    "of reyes: no edge of a micropolygon is longer in the picture,\nfrom 1/8 to 64 (1)")
        ->type_name("PIXELS")
        ->check(number_between(kLeastShadingRate, kMostShadingRate))
        ->group(group);
    verb.add_option("--displacement", flags.displacements,
                    "of reyes: the heights in a picture move surfaces of this\nmaterial along their normals by SCALE "
                    "(height - MIDDLE), in the\nmesh's own unit; MIDDLE is 0 without; may be given again")
        ->type_name("MATERIAL=FILE,SCALE[,MIDDLE]")
        ->allow_extra_args(false)
        ->group(group);
    add_photon_flags(verb, flags.photons, group);
    add_irradiance_cache_flags(verb, flags.cache, group);
    add_radiosity_flags(verb, flags.radiosity, group);
    verb.add_option("--seed", flags.seed, "of the random numbers")
        ->type_name("N")
        ->check(whole_between(0, UINT32_MAX))
        ->capture_default_str()
        ->group(group);
    verb.add_option("--filter", flags.filter, "of pixels: box, tent, gaussian or blackman-harris")
        ->type_name("NAME")
        ->check(one_of(filter_names()))
        ->capture_default_str()
        ->group(group);
    verb.add_option("--filter-radius", flags.filter_radius, "at most 64 (the filter's own)")
        ->type_name("PIXELS")
        ->check(number_above_zero(64))
        ->group(group);
}

void add_shown_picture_flags(CLI::App& verb, RenderFlags& flags) {
    const char* group = "Picture";
    verb.add_option("--size", flags.size, "in pixels (1280x720, or the shape that the scene's camera\nasks for)")
        ->type_name("WIDTHxHEIGHT")
        ->group(group);
    verb.add_option("--tone-map", flags.tone_map, "of PNG and JPEG: srgb, agx, aces or neutral (agx)")
        ->type_name("NAME")
        ->check(one_of(tone_map_names()))
        ->group(group);
    verb.add_option("--exposure", flags.exposure,
                    "of PNG and JPEG: stops, or auto, which looks at a small\npicture of its own (auto)")
        ->type_name("STOPS|auto")
        ->group(group);
    verb.add_option(
            "--f-number", flags.f_number,
            "physical exposure of PNG and JPEG: N of the lens, with\n--shutter-time and --iso (depth of field is "
            "--aperture's)")
        ->type_name("N")
        ->check(number_above_zero(1e4f))
        ->group(group);
    verb.add_option("--shutter-time", flags.shutter_s, "of --f-number: how long the shutter is open")
        ->type_name("SECONDS")
        ->check(number_above_zero(1e6f))
        ->group(group);
    verb.add_option("--iso", flags.iso, "of --f-number: the film's speed (100)")
        ->type_name("S")
        ->check(number_above_zero(1e8f))
        ->group(group);
    verb.add_option(
            "--ground", flags.ground,
            "a made-up ground that catches the shadow: on, off or auto,\nwhich is on where camera and light are "
            "made up around a thing")
        ->type_name("on|off|auto")
        ->check(one_of({"on", "off", "auto"}))
        ->capture_default_str()
        ->group("Environment");
    group = "Quality";
    add_light_path_flags(verb, flags, group);
    verb.add_option("--sampler", flags.sampler, "sobol or independent")
        ->type_name("NAME")
        ->check(one_of(sampler_names()))
        ->capture_default_str()
        ->group(group);
    verb.add_option("--clamp", flags.clamp,
                    "largest contribution of light scattered twice or more;\nbiased, off by default")
        ->type_name("X")
        ->check(number_above_zero())
        ->group(group);
    add_tracer_flags(verb, flags.tracer, "Tracing");
    group = "Machine";
    add_machine_flags(verb, flags.machine, group);
    verb.add_flag("--no-bvh-cache", flags.no_cache, "build the tree even if it was built before")->group(group);
}

void add_render_flags(CLI::App& verb, RenderFlags& flags) {
    flags.limits_memory = true;
    add_scene_options(verb, flags.scene);
    verb.add_option("-o,--output", flags.outputs, "picture to write: .exr .png .jpg .hdr; may be given again")
        ->type_name("FILE")
        ->allow_extra_args(false)
        ->check(file_name())
        ->required();
    add_shown_picture_flags(verb, flags);
    verb.add_flag("--transparent", flags.transparent, "keep how much of a pixel is covered as alpha")->group("Picture");
    verb.add_option("--aov", flags.aovs, fmt::format("layers of an EXR, of {}", fmt::join(aov_names(), ",")))
        ->type_name("NAME,...")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(one_of(aov_names()))
        ->group("Picture");
    verb.add_option(
            "--false-color", flags.false_color,
            "PNG and JPEG show numbers, and their scale beneath: luminance in\ncd/m2, or illuminance of what the "
            "camera sees in lx, of which\nEXR and HDR then hold the irradiance, W/m2")
        ->type_name("NAME")
        ->check(one_of({"luminance", "illuminance"}))
        ->group("Picture");
    verb.add_option("--false-color-range", flags.false_color_range, "ends of that scale (as fits the picture)")
        ->type_name("A,B")
        ->group("Picture");
    verb.add_option("--lpe", flags.light_paths,
                    "a layer of an EXR with the light of some paths alone, from the\nlight to the eye: LD+E, or "
                    "caustics LS+DE, or L<'lamp'>.*E;\nmay be given again, any number of times (docs/transport.md)")
        ->type_name("NAME=EXPRESSION")
        ->allow_extra_args(false)
        ->group("Picture");
    add_shutter_flag(verb, flags);
    verb.add_option("--time-limit", flags.time_limit_s,
                    "stop after this time, at a whole sample; with irradiance_cache, which\nmakes records first, "
                    "perhaps before there is one")
        ->type_name("SECONDS")
        ->check(number_above_zero())
        ->group("Quality");
    verb.add_option(
            "--denoise", flags.denoise,
            "svgf reconstructs the picture of its samples: for few of them;\nbiased. Files show that; EXR has the "
            "undenoised picture\nbeside it, as the layer noisy. none: their mean")
        ->type_name("NAME")
        ->check(one_of(denoise_names()))
        ->capture_default_str()
        ->group("Quality");
    add_time_flags(verb, flags, false);
    add_motion_flags(verb, flags);
    add_real_time_flags(verb, flags);
    verb.add_flag(
        "--strict", flags.strict,
        "fail where anything of the scene is left out, before\nrendering, and, after writing, where a sample is "
        "not finite");
    add_report_flags(verb, flags.report);
}

bool writes_tone_mapped(const RenderFlags& flags) { return writes_any(flags, {ImageFormat::Png, ImageFormat::Jpeg}); }

void check_shown_picture_flags(const RenderFlags& flags) {
    if (!flags.exposure.empty() && flags.exposure != "auto" && !number_in(flags.exposure)) {
        throw Error(ErrorCode::BadInput,
                    fmt::format("--exposure {}: expected auto, or stops: a number of size {} at most", flags.exposure,
                                std::numeric_limits<float>::max()));
    }
    check_display_flags(flags);
    if (!flags.size.empty()) parse_size("--size", flags.size);
    const RenderSettings settings = light_settings(flags);
    if (!flags.shutter.empty()) check_shutter(settings);
    Camera asked; // as far as flags say it
    asked.aperture_radius = std::max(flags.scene.aperture_m, 0.0f);
    check_camera(settings, asked);
    check_scene_options(flags.scene);
    check_camera_path(flags);
}

void check_render_flags(const RenderFlags& flags, Messages& messages) {
    check_shown_picture_flags(flags);
    check_motion_flags(flags);
    check_real_time_flags(flags);
    refuse(flags.denoise != name_of(Denoise::None) && flags.max_depth == 0,
           "--denoise: with --max-depth 0 no light is scattered, so that there is nothing to denoise");
    const std::optional<FrameSequence> frames = frame_sequence(flags);
    RenderSettings size; // where no flag tells it, it is small enough for every format
    if (!flags.size.empty()) std::tie(size.width, size.height) = parse_size("--size", flags.size);
    for (const std::string& output : flags.outputs) {
        refuse_list(output);
        check_image_output(frames ? frame_file(output, frames->first) : output, size.width, size.height);
        if (frames || !names_frames(output)) continue;
        messages.note(fmt::format("-o {}: # stands for a frame's number with --frames A-B or --turntable N alone; this "
                                  "is one picture, whose file is called so",
                                  output));
    }
    refuse_twins(flags.outputs, frames);
    if (!flags.aovs.empty() && !writes_any(flags, {ImageFormat::Exr})) {
        throw Error(ErrorCode::BadInput, "--aov: layers are kept in EXR files alone; add -o NAME.exr");
    }
    if (!flags.light_paths.empty() && !writes_any(flags, {ImageFormat::Exr})) {
        throw Error(ErrorCode::BadInput, "--lpe: layers are kept in EXR files alone; add -o NAME.exr");
    }
    if (flags.transparent && std::ranges::none_of(flags.outputs, keeps_alpha)) {
        throw Error(ErrorCode::BadInput, "--transparent: alpha is kept in EXR and PNG alone; add -o NAME.exr or .png");
    }
    for (const std::string& output : flags.outputs) {
        if (flags.transparent && !keeps_alpha(output)) {
            messages.warn(output + ": --transparent: this format has no alpha; the background becomes black");
        }
    }
    refuse(flags.false_color == "luminance" && !writes_tone_mapped(flags),
           "--false-color luminance: numbers are shown in PNG and JPEG alone; add -o NAME.png");
    refuse(!flags.false_color.empty() && flags.false_color_range.empty() && frames && writes_tone_mapped(flags),
           "--false-color: frames of a sequence need one scale for all; say --false-color-range");
    refuse(flags.f_number > 0 && !writes_tone_mapped(flags),
           "--f-number: light is exposed in PNG and JPEG alone; add -o NAME.png or .jpg");
    if ((!flags.exposure.empty() || !flags.tone_map.empty()) && !writes_tone_mapped(flags)) {
        throw Error(ErrorCode::BadInput, fmt::format("--{}: light is mapped to tones in PNG and JPEG alone; add -o "
                                                     "NAME.png or .jpg",
                                                     flags.exposure.empty() ? "tone-map" : "exposure"));
    }
}

RenderSettings render_settings(const RenderFlags& flags, const Scene& scene) {
    RenderSettings settings = light_settings(flags);
    if (settings.light_paths) {
        settings.light_paths =
            std::make_shared<const LightPathLayers>(put_to_scene(settings.light_paths->expressions, scene));
    }
    settings.heights = read_height_maps(height_maps(flags), scene);
    if (!flags.size.empty()) {
        std::tie(settings.width, settings.height) = parse_size("--size", flags.size);
    } else {
        set_default_size(settings, scene_camera(flags.scene, scene));
    }
    const std::size_t of_ids = (settings.aovs & kAovIds) != 0 ? 3 : 0;
    check_exr_row(settings.width,
                  film_channel_count(settings.aovs) + of_ids + std::size_t(3) * light_layers_of(settings));
    return settings;
}

} // namespace pertev
