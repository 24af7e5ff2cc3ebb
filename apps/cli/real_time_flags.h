#pragma once

// The flags of pertev render --real-time: frames of a sequence as pertev view shows them while it moves.

#include "apps/cli/render_flags.h"

namespace pertev {

/// --real-time, and how its frames are reconstructed, which no other picture asks.
void add_real_time_flags(CLI::App& verb, RenderFlags& flags);
/// Once the line is read: which of these flags it has, and one sample a pixel where it says no other number.
void note_real_time_flags(const CLI::App& verb, RenderFlags& flags);
/// What can be told of them before the scene is read. Throws Error(BadInput) for what such frames have not got.
void check_real_time_flags(const RenderFlags& flags);

} // namespace pertev
