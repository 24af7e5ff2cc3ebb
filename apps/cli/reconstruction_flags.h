#pragma once

// Flags of frames in real time: how they are reconstructed, which light their pixels share, at which resolution it is
// found. Of all commands that make such frames.

#include <string>

#include "denoise/reconstruction_settings.h"
#include "restir/restir_settings.h"

namespace CLI {
class App;
}

namespace pertev {

/// All that is biased can be switched off.
struct ReconstructionFlags {
    ReconstructionSettings settings;
    RestirSettings sharing;
    std::string restir; // which light is shared: the value of --restir
    bool none = false;
    bool no_firefly_limit = false, no_history_limit = false, no_anti_alias = false, no_follow_light = false;
};

/// Under this heading of the help.
void add_reconstruction_flags(CLI::App& verb, ReconstructionFlags& flags, const std::string& group);
/// As the flags say; with --no-reconstruction of_samples_alone.
ReconstructionSettings reconstruction_settings(const ReconstructionFlags& flags);
/// Throws Error(BadInput) where both ReSTIR and an order of samples are asked for.
RestirSettings restir_settings(const ReconstructionFlags& flags);
/// Whether there is something that frames of integrators alone have that make them (makes_frames).
bool ask_for_frames(const ReconstructionFlags& flags);
/// All of both as a JSON object: what makes the bytes of a frame, beside the picture's own settings.
std::string json_of(const ReconstructionFlags& flags);

} // namespace pertev
