#pragma once

// The frames of pertev render --frames and --turntable, as a person or a program reads of them.

#include "apps/cli/render_flags.h"
#include "session/pictures/render_sequence.h"

namespace pertev {

/// Renders and writes the frames by write_sequence and reports them. Ctrl-C ends after the last whole frame. Returns
/// the exit status. Throws Error.
int render_frames(const RenderFlags& flags, const SequenceOfFrames& frames, Reporter& reporter);

} // namespace pertev
