#pragma once

// The frames of pertev render --frames and --turntable, rendered in one session, which keeps from frame to frame
// whatever does not move.

#include "apps/cli/render_flags.h"
#include "session/pictures/render_sequence.h"

namespace pertev {

/// The first real-time frame of the requested sequence.
ReconstructedFrame reconstructed_frame(const RenderFlags& flags, const FrameRange& sequence);

/// `moving`, `session` and `record` are those of the first frame, with the exposure of all frames. If record.frame is
/// set, frames are in real time, and the first one follows a cut. Ctrl-C ends after the last whole frame. Returns the
/// exit status. Throws Error.
int render_frames(const RenderFlags& flags, const FrameCamera& camera, MovingScene& moving, PictureRecord& record,
                  Session& session, Reporter& reporter);

} // namespace pertev
