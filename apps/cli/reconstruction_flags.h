#pragma once

// Options of real-time frames: reconstruction, ReSTIR, lower resolution. All verbs with such frames have these
// settings.

#include <string>

#include "settings/picture_options.h"

namespace pertev {

/// Returns the requested settings; without reconstruction of_samples_alone.
ReconstructionSettings reconstruction_settings(const ReconstructionOptions& options);
/// Returns whether an option is set that only integrators with frames have (makes_frames).
bool has_frame_options(const ReconstructionOptions& options);
/// Returns everything that determines the bytes of a frame, besides the picture's own settings, as a JSON object.
std::string json_of(const ReconstructionOptions& options);

} // namespace pertev
