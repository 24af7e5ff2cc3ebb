#pragma once

// The settings that make a picture again, also one frame of a sequence.

#include <cstdint>
#include <string>

#include "session/writing/picture_metadata.h"
#include "settings/picture_options.h"

namespace pertev {

/// Returns a file of settings (settings/settings_file.h) with the record's size and scene. If the options ask for
/// `frames`, they make this frame alone: by its `time`, with the exposure of the record; or as the last of its
/// sequence if it is in real time, turned by `turntable`, or has motion vectors. A frame of `turntable` without
/// `frames` has the settings of the whole turn.
std::string settings_of_frame(PictureOptions options, const PictureRecord& record, uint32_t frame);

} // namespace pertev
