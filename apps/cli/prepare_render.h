#pragma once

// The common start of render and view: the session's prepare_render, and its messages.

#include "apps/cli/render_flags.h"
#include "session/pictures/prepare_render.h"

namespace pertev {

/// Prepares everything and reports on the way. Throws Error.
std::unique_ptr<RenderSetup> prepare_render(RenderFlags& flags, uint32_t verbs, Reporter& reporter);

/// Notes what a time would show if none is given, or that a given time has no effect.
void report_motion(const RenderFlags& flags, const MovingScene& moving, Messages& messages);

} // namespace pertev
