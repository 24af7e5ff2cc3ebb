#pragma once

// The flags of pertev render, made from the table of settings, and their checks.

#include <optional>
#include <string>
#include <vector>

#include "apps/cli/radiosity_flags.h"
#include "apps/cli/reporter.h"
#include "apps/cli/scene_options.h"
#include "apps/cli/setting_flags.h"
#include "session/frame_range.h"
#include "session/machine.h"
#include "session/opening/picture_settings.h"
#include "session/pictures/choose_display.h"
#include "settings/tracer_options.h"
#include "settings/value_names.h"

namespace pertev {

struct RenderFlags : PictureOptions {
    std::vector<std::string> outputs;
    bool limits_memory = false; // --max-memory applies to all integrators
    SettingFlags settings;
    ReportFlags report;
};

/// Returns whether an output is tone-mapped: PNG or JPEG.
bool writes_tone_mapped(const RenderFlags& flags);

/// Checks everything that can be checked before the scene is read. Throws Error, especially for an output that cannot
/// be written.
void check_render_flags(const RenderFlags& flags, Messages& messages);
/// Checks the part that also applies to a picture on a screen.
void check_shown_picture_flags(const RenderFlags& flags);
/// Checks flags of motion and time.
void check_motion_flags(const RenderFlags& flags);
/// Checks real-time frames. Throws Error(BadInput) for features that they lack.
void check_real_time_flags(const RenderFlags& flags);

} // namespace pertev
