#pragma once

// These are the flags of pertev render and what follows from them. They are made of the table of settings.

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
    bool limits_memory = false; // --max-memory counts for all integrators
    SettingFlags settings;
    ReportFlags report;
};

/// Whether a picture is asked for that light is mapped to tones for: PNG or JPEG.
bool writes_tone_mapped(const RenderFlags& flags);

/// Checks what can be told before the scene is read. Throws Error, above all for an output that could not be written.
void check_render_flags(const RenderFlags& flags, Messages& messages);
/// Checks the part of it that a picture on a screen has, too.
void check_shown_picture_flags(const RenderFlags& flags);
/// Checks what moves, and when.
void check_motion_flags(const RenderFlags& flags);
/// Checks frames in real time. Throws Error(BadInput) for what such frames have not got.
void check_real_time_flags(const RenderFlags& flags);

} // namespace pertev
