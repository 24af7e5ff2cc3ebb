#include "session/opening/camera_list.h"

#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "session/opening/calibrated_camera.h"
#include "settings/check_settings.h"

namespace pertev {

namespace {

/// Returns the eyes of stereo pairs in place of cameras, the left one first.
std::vector<CameraOfFile> eyes_of(const std::vector<CameraOfFile>& cameras, double distance) {
    std::vector<CameraOfFile> eyes;
    for (const CameraOfFile& camera : cameras) {
        for (const SuggestedSetting& setting : camera.settings) {
            if (setting.name != "eye_offset") continue;
            throw Error(ErrorCode::BadInput,
                        Remark(camera.location, fmt::format("`{}` cannot be combined with `stereo`", setting.name)));
        }
        for (const auto& [name, offset] : {std::pair("left", -0.5 * distance), {"right", 0.5 * distance}}) {
            CameraOfFile& eye = eyes.emplace_back(camera);
            eye.name = camera.name.empty() ? name : fmt::format("{}-{}", camera.name, name);
            eye.settings.push_back({"eye_offset", fmt::format("{}", offset)});
        }
    }
    return eyes;
}

} // namespace

void read_camera_list(PictureOptions& options) {
    if ((options.cameras.empty() && !options.stereo) || options.camera_list) return;
    std::vector<CameraOfFile> cameras(1);
    if (!options.cameras.empty()) {
        const PictureSize size = options.size.value_or(PictureSize{});
        cameras = read_cameras(options.cameras, size.width, size.height);
    }
    if (options.stereo) cameras = eyes_of(cameras, *options.stereo);
    options.camera_list = std::make_shared<const std::vector<CameraOfFile>>(std::move(cameras));
}

PictureOptions options_of_camera(const PictureOptions& options, uint32_t number, uint32_t verbs) {
    const CameraOfFile& camera = (*options.camera_list)[number];
    PictureOptions own = options;
    for (const char* name : {"cameras", "stereo", "continue"}) own.given.erase(name);
    own.cameras.clear();
    own.stereo.reset();
    own.camera_list.reset();
    own.goes_on = false;
    const auto refuse = [&](Remark why) {
        why.location = camera.location;
        throw Error(ErrorCode::BadInput, std::move(why));
    };
    for (const auto& [name, text] : camera.settings) {
        const Setting* const setting = find_setting(name);
        const bool is_of_cameras = setting != nullptr && (setting->group == SettingGroup::Camera || name == "size");
        if (!is_of_cameras) refuse(Remark(name, text, "not a setting of a camera"));
        try {
            set_value(own, *setting, {&text, 1});
            check_aperture(own.scene.camera);
        } catch (const Error& error) {
            refuse(error.remark());
        }
    }
    if (const auto conflict = find_conflict(own, verbs)) refuse(remark_of(*conflict, own));
    apply_camera_from(own);
    return own;
}

} // namespace pertev
