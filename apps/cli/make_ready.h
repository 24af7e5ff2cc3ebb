#pragma once

// render and view begin with this alike: the session's make_ready, and what is said of it.

#include "apps/cli/render_flags.h"
#include "session/pictures/ready_scene.h"

namespace pertev {

/// Says what there is to say on the way. Throws Error.
std::unique_ptr<ReadyScene> make_ready(RenderFlags& flags, uint32_t verbs, Reporter& reporter);

/// Says what a time would show if none is given, or that one shows nothing.
void say_what_moves(const RenderFlags& flags, const MovingScene& moving, Messages& messages);

} // namespace pertev
