#pragma once

// Renders one picture of a prepared scene and keeps nothing: a session (session/session.h) that renders once.

#include "session/session.h"

namespace pertev {

/// Renders `settings.samples` samples, or fewer when time is over or `keep_going` (called after each pass) returns
/// false; at least one sample. Throws Error(OutOfMemory, DeviceFault).
RenderResult render_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera,
                            const RenderSettings& settings,
                            const std::function<bool(const RenderProgress&)>& keep_going = {});

} // namespace pertev
