#include "apps/cli/render_flags.h"

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "base/error.h"
#include "image/write_exr.h"
#include "image/write_image.h"
#include "session/check_integrator.h"
#include "session/height_maps.h"
#include "settings/parse_values.h"

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

/// Without a scene: what can be told of them before it is read.
LightPathLayers light_paths(const RenderFlags& flags) {
    LightPathLayers layers;
    for (const std::string& text : flags.lpe) layers.expressions.push_back(parse_light_path(text));
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

std::vector<HeightMapText> height_maps(const RenderFlags& flags) {
    std::vector<HeightMapText> maps;
    for (const std::string& text : flags.displacement) maps.push_back(parse_height_map(text));
    return maps;
}

/// All settings but the size. Throws Error where they do not go together.
RenderSettings light_settings(const RenderFlags& flags) {
    RenderSettings settings = flags.render;
    for (const std::string& name : flags.aovs) settings.aovs |= *aov_named(name); // which has been checked
    settings.irradiance = flags.false_color == "illuminance";
    if (!flags.lpe.empty()) settings.light_paths = std::make_shared<const LightPathLayers>(light_paths(flags));
    check_radiosity_flags(flags.radiosity, settings, flags.limits_memory);
    check_integrator(settings);
    height_maps(flags);
    return settings;
}

} // namespace

std::optional<PhysicalExposure> physical_exposure(const PictureOptions& options) {
    if (!(options.f_number > 0)) return std::nullopt;
    PhysicalExposure exposure;
    if (options.iso > 0) exposure.iso = static_cast<double>(options.iso);
    exposure.f_number = static_cast<double>(options.f_number);
    exposure.shutter_s = static_cast<double>(options.shutter_s);
    return exposure;
}

std::optional<FalseColors> false_colors(const PictureOptions& options) {
    if (options.false_color.empty()) return std::nullopt;
    FalseColors colors;
    colors.quantity = options.false_color;
    colors.unit = options.false_color == "illuminance" ? "lx" : "cd/m2";
    colors.factor = static_cast<float>(efficacy_of(options.scene));
    if (!options.false_color_range.empty())
        std::tie(colors.least, colors.most) = parse_range(options.false_color_range);
    return colors;
}

bool writes_tone_mapped(const RenderFlags& flags) { return writes_any(flags, {ImageFormat::Png, ImageFormat::Jpeg}); }

void check_shown_picture_flags(const RenderFlags& flags) {
    if (!flags.exposure.empty() && flags.exposure != "auto" && !number_in(flags.exposure)) {
        throw Error(ErrorCode::BadInput,
                    fmt::format("--exposure {}: expected auto, or stops: a number of size {} at most", flags.exposure,
                                std::numeric_limits<float>::max()));
    }
    if (!flags.false_color_range.empty()) parse_range(flags.false_color_range);
    const RenderSettings settings = light_settings(flags);
    if (!flags.shutter.empty()) check_shutter(settings);
    Camera asked; // as far as flags say it
    asked.aperture_radius = std::max(flags.scene.camera.aperture.value_or(0), 0.0f);
    check_camera(settings, asked);
    check_scene_options(flags.scene);
}

void check_render_flags(const RenderFlags& flags, Messages& messages) {
    check_shown_picture_flags(flags);
    check_motion_flags(flags);
    check_real_time_flags(flags);
    refuse(flags.render.denoise != Denoise::None && flags.render.path.max_depth == 0,
           "--denoise: with --max-depth 0 no light is scattered, so that there is nothing to denoise");
    const std::optional<FrameSequence> frames = frame_sequence(flags);
    const PictureSize size = flags.size.value_or(PictureSize{1280, 720}); // without one it is small enough, too
    for (const std::string& output : flags.outputs) {
        refuse_list(output);
        check_image_output(frames ? frame_file(output, frames->first) : output, size.width, size.height);
        if (!frames) note_number_signs(output, "with --frames A-B or --turntable N alone", messages);
    }
    refuse_twins(flags.outputs, frames);
    // A file of settings may be for other outputs: what they cannot keep is refused where a flag asks for it.
    const auto by_flag = [&](std::string_view name) {
        const auto given = flags.given.find(name);
        return given != flags.given.end() && given->second == SettingOrigin::Flag;
    };
    refuse(by_flag("aov") && !writes_any(flags, {ImageFormat::Exr}),
           "--aov: layers are kept in EXR files alone; add -o NAME.exr");
    refuse(by_flag("lpe") && !writes_any(flags, {ImageFormat::Exr}),
           "--lpe: layers are kept in EXR files alone; add -o NAME.exr");
    refuse(by_flag("transparent") && std::ranges::none_of(flags.outputs, keeps_alpha),
           "--transparent: alpha is kept in EXR and PNG alone; add -o NAME.exr or .png");
    for (const std::string& output : flags.outputs) {
        if (flags.render.transparent && !keeps_alpha(output)) {
            messages.warn(output + ": --transparent: this format has no alpha; the background becomes black");
        }
    }
    refuse(by_flag("false_color") && flags.false_color == "luminance" && !writes_tone_mapped(flags),
           "--false-color luminance: numbers are shown in PNG and JPEG alone; add -o NAME.png");
    refuse(!flags.false_color.empty() && flags.false_color_range.empty() && frames && writes_tone_mapped(flags),
           "--false-color: frames of a sequence need one scale for all; say --false-color-range");
    refuse(by_flag("f_number") && !writes_tone_mapped(flags),
           "--f-number: light is exposed in PNG and JPEG alone; add -o NAME.png or .jpg");
    for (const char* name : {"exposure", "tone_map"}) {
        refuse(by_flag(name) && !writes_tone_mapped(flags),
               flag_of(name) + ": light is mapped to tones in PNG and JPEG alone; add -o NAME.png or .jpg");
    }
}

RenderSettings render_settings(const RenderFlags& flags, const Scene& scene) {
    RenderSettings settings = light_settings(flags);
    if (settings.light_paths) {
        settings.light_paths =
            std::make_shared<const LightPathLayers>(put_to_scene(settings.light_paths->expressions, scene));
    }
    settings.heights = read_height_maps(height_maps(flags), scene);
    if (flags.size) {
        settings.width = flags.size->width, settings.height = flags.size->height;
    } else {
        set_default_size(settings, scene_camera(flags.scene.camera.camera, scene));
    }
    const std::size_t of_ids = (settings.aovs & kAovIds) != 0 ? 3 : 0;
    check_exr_row(settings.width,
                  film_channel_count(settings.aovs) + of_ids + std::size_t(3) * light_layers_of(settings));
    return settings;
}

} // namespace pertev
