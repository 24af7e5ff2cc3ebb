#include "session/pictures/check_options.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include "base/error.h"
#include "denoise/oidn/oidn_library.h"
#include "session/check_integrator.h"
#include "session/crop.h"
#include "session/frame_range.h"
#include "session/opening/calibrated_camera.h"
#include "session/opening/open_scene.h"
#include "session/opening/picture_settings.h"
#include "session/opening/set_profiles.h"
#include "session/pictures/choose_display.h"
#include "session/sample_range.h"
#include "session/set_materials.h"
#include "settings/check_settings.h"

namespace pertev {
namespace {

void check_real_time(const PictureOptions& options) {
    const auto layer =
        std::ranges::find_if(options.aovs, [](const auto& aov) { return sample_layer_named(aov).has_value(); });
    if (options.real_time && layer != options.aovs.end()) {
        throw Error(ErrorCode::BadInput, "aov", *layer, "frames with `real_time` do not have this layer");
    }
    if (!options.real_time || options.render.samples == 1) return;
    throw Error(ErrorCode::BadInput, "spp", fmt::format("{}", options.render.samples),
                "a frame with `real_time` has one sample per pixel");
}

/// Refuses settings of a history that a denoised picture does not have.
void check_history(const PictureOptions& options, uint32_t verbs) {
    if ((verbs & kRender) == 0 || options.real_time || options.is_sequence()) return;
    for (const char* const name : {"history", "cuts"}) {
        if (options.is_given(name)) throw Error(ErrorCode::BadInput, name, "", "needs `frames` or `turntable`");
    }
}

void check_solution(const std::string& file) {
    if (std::error_code fault; file.empty() || std::filesystem::exists(file, fault)) return;
    throw Error(ErrorCode::BadInput, "solution", file, "the file does not exist");
}

/// Refuses a crop that no picture has, or that the requested size does not have.
void check_crop(const PictureOptions& options) {
    RenderSettings settings;
    settings.width = settings.height = UINT32_MAX;
    if (options.size) settings.width = options.size->width, settings.height = options.size->height;
    set_crop(options, settings);
    if (settings.crop && !options.false_color.empty() && options.false_color_range.empty()) {
        throw Error(ErrorCode::BadInput, "false_color", options.false_color,
                    "a crop has the whole picture's scale only if that is stated; set `false_color_range`");
    }
}

} // namespace

void check_options(const PictureOptions& options, uint32_t verbs) {
    check_settings(options, verbs);
    frame_range(options);
    sample_range(options);
    row_range(options);
    check_crop(options);
    check_real_time(options);
    check_history(options, verbs);
    if (options.reconstruction.used().denoiser == FrameDenoiser::Oidn) OidnLibrary::find("frame_denoiser");
    requested_exposure(options);
    if (!options.lut.empty()) CubeLut::read(options.lut);
    false_colors(options);
    const RenderSettings settings = light_settings(options);
    check_aperture(options.scene.camera);
    Camera requested; // a camera of the scene may have a lens too
    requested.aperture_radius = std::max(options.scene.camera.aperture.value_or(0), 0.0f);
    check_camera(settings, requested);
    read_options(options.scene);
    if (!options.scene.sun_sky.empty()) sun_sky(options.scene);
    for (const std::string& emitter : options.scene.emitters) parse_emitter(emitter);
    for (const std::string& profile : options.scene.profiles) static_cast<void>(file_of_profile(profile));
    for (const std::string& material : options.scene.materials) parse_material_change(material);
    check_solution(options.radiosity.solution);
}

void complete_options(PictureOptions& options, uint32_t verbs) {
    if (options.real_time && !options.is_given("spp")) options.render.samples = 1;
    if (!options.samples.empty()) options.render.samples = sample_range(options).end;
    check_options(options, verbs);
}

} // namespace pertev
