#pragma once

// The initial state of a viewer for a picture that is ready to render.

#include <cstdint>
#include <optional>

#include "apps/viewer/session_frames.h"
#include "apps/viewer/viewer.h"
#include "session/pictures/prepare_render.h"

namespace pertev {

/// Returns the state in which a viewer shows the picture, which outlives it. `source` finds the point in the middle,
/// and the exposure if it is metered. `moving_depth` is the maximum path depth in motion, if it was given.
ViewerStart start_viewer(const PictureOptions& options, const RenderSetup& ready, const PictureRecord& record,
                         const Display& display, SessionFrames& source, std::optional<uint32_t> moving_depth);

} // namespace pertev
