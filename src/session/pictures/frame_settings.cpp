#include "session/pictures/frame_settings.h"

#include <fmt/format.h>

#include "render/film_channels.h"
#include "session/frame_range.h"
#include "session/opening/camera_list.h"
#include "session/pictures/choose_display.h"
#include "settings/settings_file.h"

namespace pertev {
namespace {

void set(PictureOptions& options, const char* name, const std::string& text) {
    const auto given = options.given.find(name);
    const SettingOrigin origin = given != options.given.end() ? given->second : SettingOrigin::File;
    set_value(options, *find_setting(name), {&text, 1}, origin);
}

/// Replaces the frames by one.
void keep_frame(PictureOptions& options, const PictureRecord& record, uint32_t frame) {
    const bool has_motion = (record.settings.aovs & kAovMotion) != 0;
    if (record.in_sequence || options.turntable > 0 || has_motion) {
        options.given.erase("cuts");
        options.cuts.clear(); // no later one than the frame with which its history begins
        const uint32_t first = record.in_sequence ? record.in_sequence->cut : frame;
        return set(options, "frames", fmt::format("{}-{}", first, frame));
    }
    for (const char* name : {"frames", "fps", "history", "cuts"}) options.given.erase(name); // the last two need frames
    options.frames.clear();
    set(options, "time", fmt::format("{}", record.scene.time_s.value()));
}

} // namespace

std::string settings_of_frame(PictureOptions options, const PictureRecord& record, uint32_t frame) {
    const bool shares_exposure = options.camera_list || !options.frames.empty();
    if (options.camera_list) options = options_of_camera(options, frame, kRender);
    if (shares_exposure && record.display && is_metered(options))
        set(options, "exposure", fmt::format("{}", record.display->exposure_stops));
    options.size = PictureSize{record.settings.width, record.settings.height};
    options.given.try_emplace("size", SettingOrigin::File);
    options.given.try_emplace("spp", SettingOrigin::File);
    if (!options.frames.empty()) keep_frame(options, record, frame);
    return settings_json(options, record.scene.hash);
}

} // namespace pertev
