#include "apps/cli/render_flags.h"

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "apps/cli/flag_checks.h"
#include "base/error.h"
#include "image/write_image.h"
#include "session/check_integrator.h"
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
std::filesystem::path canonical_path(const std::string& file) {
    constexpr int kMaxLinks = 40; // limit of Linux
    std::error_code fault;        // after an error the path is resolved as far as possible
    std::filesystem::path full_path = std::filesystem::absolute(file, fault);
    for (int i = 0; i < kMaxLinks && std::filesystem::is_symlink(full_path, fault); ++i) {
        full_path = full_path.parent_path() / std::filesystem::read_symlink(full_path, fault);
    }
    const std::filesystem::path known = std::filesystem::weakly_canonical(full_path, fault);
    return fault ? full_path : known;
}

/// Throws Error(BadInput) where two outputs are one file, of which the second picture would replace the first; of a
/// sequence, where they are at some frame.
void refuse_twins(const std::vector<std::string>& outputs, const std::optional<FrameRange>& frames) {
    std::map<std::filesystem::path, std::string> taken;
    for (const std::string& output : outputs) {
        const std::string file = frames ? frame_file(output, frames->last) : output; // the most digits
        const auto [entry, is_new] = taken.emplace(canonical_path(file), output);
        if (is_new) continue;
        throw Error(ErrorCode::BadInput,
                    fmt::format("-o {}: -o {} names the same file{}; leave out one of them", output, entry->second,
                                frames ? fmt::format(" for frame {}", frames->last) : ""));
    }
}

} // namespace

bool writes_tone_mapped(const RenderFlags& flags) { return writes_any(flags, {ImageFormat::Png, ImageFormat::Jpeg}); }

void check_shown_picture_flags(const RenderFlags& flags) {
    if (!flags.exposure.empty() && flags.exposure != "auto" && !number_in(flags.exposure)) {
        throw Error(ErrorCode::BadInput,
                    fmt::format("--exposure {}: expected auto, or stops: a number of size {} at most", flags.exposure,
                                std::numeric_limits<float>::max()));
    }
    false_colors(flags);
    const RenderSettings settings = light_settings(flags);
    check_radiosity_flags(flags.radiosity, settings, flags.limits_memory);
    if (!flags.shutter.empty()) check_shutter(settings);
    Camera requested; // defined by flags only
    requested.aperture_radius = std::max(flags.scene.camera.aperture.value_or(0), 0.0f);
    check_camera(settings, requested);
    check_scene_options(flags.scene);
}

void check_render_flags(const RenderFlags& flags, Messages& messages) {
    check_shown_picture_flags(flags);
    check_motion_flags(flags);
    check_real_time_flags(flags);
    refuse(flags.render.denoise != Denoise::None && flags.render.path.max_depth == 0,
           "--denoise: with --max-depth 0 no light is scattered, so that there is nothing to denoise");
    const std::optional<FrameRange> frames = frame_range(flags);
    const PictureSize size = flags.size.value_or(PictureSize{1280, 720}); // without one it is small enough, too
    for (const std::string& output : flags.outputs) {
        refuse_list(output);
        check_image_output(frames ? frame_file(output, frames->first) : output, size.width, size.height);
        if (!frames) note_number_signs(output, "only with --frames A-B or --turntable N", messages);
    }
    refuse_twins(flags.outputs, frames);
    // A file of settings may be for other outputs: what they cannot keep is refused where a flag asks for it.
    const auto by_flag = [&](std::string_view name) {
        const auto given = flags.given.find(name);
        return given != flags.given.end() && given->second == SettingOrigin::Caller;
    };
    refuse(by_flag("aov") && !writes_any(flags, {ImageFormat::Exr}),
           "--aov applies only to EXR output; add -o NAME.exr");
    refuse(by_flag("lpe") && !writes_any(flags, {ImageFormat::Exr}),
           "--lpe applies only to EXR output; add -o NAME.exr");
    refuse(by_flag("transparent") && std::ranges::none_of(flags.outputs, keeps_alpha),
           "--transparent applies only to EXR and PNG output; add -o NAME.exr or .png");
    for (const std::string& output : flags.outputs) {
        if (flags.render.transparent && !keeps_alpha(output)) {
            messages.warn(output + ": --transparent: this format has no alpha; the background becomes black");
        }
    }
    refuse(by_flag("false_color") && flags.false_color == "luminance" && !writes_tone_mapped(flags),
           "--false-color luminance applies only to PNG and JPEG output; add -o NAME.png");
    refuse(!flags.false_color.empty() && flags.false_color_range.empty() && frames && writes_tone_mapped(flags),
           "--false-color: the frames of a sequence need one scale; add --false-color-range");
    refuse(by_flag("f_number") && !writes_tone_mapped(flags),
           "--f-number applies only to PNG and JPEG output; add -o NAME.png or .jpg");
    for (const char* name : {"exposure", "tone_map"}) {
        refuse(by_flag(name) && !writes_tone_mapped(flags),
               flag_of(name) + " applies only to PNG and JPEG output; add -o NAME.png or .jpg");
    }
}

} // namespace pertev
