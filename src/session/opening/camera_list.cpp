#include "session/opening/camera_list.h"

#include <utility>

#include "base/error.h"
#include "session/opening/calibrated_camera.h"
#include "settings/check_settings.h"

namespace pertev {

void read_camera_list(PictureOptions& options) {
    if (options.cameras.empty() || options.camera_list) return;
    const PictureSize size = options.size.value_or(PictureSize{});
    options.camera_list =
        std::make_shared<const std::vector<CameraOfFile>>(read_cameras(options.cameras, size.width, size.height));
}

PictureOptions options_of_camera(const PictureOptions& options, uint32_t number, uint32_t verbs) {
    const CameraOfFile& camera = (*options.camera_list)[number];
    PictureOptions own = options;
    for (const char* name : {"cameras", "continue"}) own.given.erase(name);
    own.cameras.clear();
    own.camera_list.reset();
    own.goes_on = false;
    const auto refuse = [&](Remark why) {
        why.location = camera.location;
        throw Error(ErrorCode::BadInput, std::move(why));
    };
    for (const auto& [name, text] : camera.settings) {
        const Setting* const setting = find_setting(name);
        const bool is_of_cameras =
            setting != nullptr && (setting->group == std::string_view("Camera") || name == "size");
        if (!is_of_cameras) refuse(Remark(name, text, "not a setting of a camera"));
        try {
            set_value(own, *setting, {&text, 1});
        } catch (const Error& error) {
            refuse(error.remark());
        }
    }
    if (const auto conflict = find_conflict(own, verbs)) refuse(remark_of(*conflict, own));
    apply_camera_from(own);
    return own;
}

} // namespace pertev
