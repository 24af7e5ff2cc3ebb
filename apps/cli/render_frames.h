#pragma once

// The frames of pertev render --frames and --turntable: one after the other by one session, which takes over from frame
// to frame what does not move.

#include "apps/cli/render_flags.h"
#include "session/pictures/render_sequence.h"

namespace pertev {

/// The first frame in real time of a sequence that these flags ask for.
ReconstructedFrame reconstructed_frame(const RenderFlags& flags, const FrameRange& sequence);

/// `moving`, `session` and `record` are those of the first frame, exposed as all frames will be. Where record.frame is
/// there, frames are in real time: the first one comes after a cut. Ctrl-C ends after the last whole frame. Returns the
/// exit status. Throws Error.
int render_frames(const RenderFlags& flags, const FrameCamera& camera, MovingScene& moving, PictureRecord& record,
                  Session& session, Reporter& reporter);

} // namespace pertev
