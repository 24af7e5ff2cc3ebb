#pragma once

// How frames in real time are made: reconstructed, by shared light, at a lower resolution. All verbs that make such
// frames have these settings.

#include <string>

#include "settings/picture_options.h"

namespace pertev {

/// Returns what is asked for; without reconstruction it is of_samples_alone.
ReconstructionSettings reconstruction_settings(const ReconstructionOptions& options);
/// Whether there is something that frames of integrators alone have that make them (makes_frames).
bool ask_for_frames(const ReconstructionOptions& options);
/// Returns all of it as a JSON object: what makes the bytes of a frame, beside the picture's own settings.
std::string json_of(const ReconstructionOptions& options);

} // namespace pertev
