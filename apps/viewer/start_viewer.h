#pragma once

// The initial state of a viewer for a picture that is ready to render.

#include "apps/viewer/session_frames.h"
#include "apps/viewer/viewer.h"
#include "session/pictures/prepare_render.h"

namespace pertev {

/// Returns the state in which a viewer shows the picture, which outlives it. `source` finds the point in the middle,
/// and the exposure if it is metered.
ViewerStart start_viewer(const PictureOptions& options, const RenderSetup& ready, const PictureRecord& record,
                         const Display& display, SessionFrames& source);

} // namespace pertev
