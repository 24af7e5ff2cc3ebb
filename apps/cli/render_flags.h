#pragma once

// These are the flags of pertev render and what follows from them. They are made of the table of settings.

#include <optional>
#include <string>
#include <vector>

#include "apps/cli/choose_device.h"
#include "apps/cli/radiosity_flags.h"
#include "apps/cli/reporter.h"
#include "apps/cli/scene_options.h"
#include "apps/cli/setting_flags.h"
#include "apps/cli/tracer_flags.h"
#include "session/frame_sequence.h"
#include "session/photometry.h"
#include "session/writing/picture_metadata.h"
#include "settings/value_names.h"

namespace pertev {

struct RenderFlags : PictureOptions {
    std::vector<std::string> outputs;
    bool limits_memory = false; // --max-memory counts for all integrators
    SettingFlags settings;
    ReportFlags report;
};

/// Returns how long the shutter is open; none where that is not given. Throws Error(BadInput).
std::optional<Shutter> shutter(const PictureOptions& options);

/// Returns the exposure of a lens and a film; none where that is not given.
std::optional<PhysicalExposure> physical_exposure(const PictureOptions& options);

/// Returns the numbers that PNG and JPEG show; none where tones are shown. A scale without a range fits the picture.
std::optional<FalseColors> false_colors(const PictureOptions& options);

/// Whether a picture is asked for that light is mapped to tones for: PNG or JPEG.
bool writes_tone_mapped(const RenderFlags& flags);

/// Returns the frames that are asked for; none for a single picture. Throws Error(BadInput).
std::optional<FrameSequence> frame_sequence(const PictureOptions& options);

/// Checks what can be told before the scene is read. Throws Error, above all for an output that could not be written.
void check_render_flags(const RenderFlags& flags, Messages& messages);
/// Checks the part of it that a picture on a screen has, too.
void check_shown_picture_flags(const RenderFlags& flags);
/// Checks what moves, and when.
void check_motion_flags(const RenderFlags& flags);
/// Checks frames in real time. Throws Error(BadInput) for what such frames have not got.
void check_real_time_flags(const RenderFlags& flags);

/// Returns the settings for a scene. Throws Error.
RenderSettings render_settings(const RenderFlags& flags, const Scene& scene);

} // namespace pertev
