#pragma once

// Renders one picture of a prepared scene and keeps nothing: a session (session/session.h) that renders once.

#include "session/session.h"

namespace pertev {

/// Renders `settings.samples` samples, or fewer when time is over or `sink` stops. Throws Error(OutOfMemory,
/// DeviceFault).
RenderResult render_picture(Queue& queue, const PreparedScene& prepared, const Camera& camera,
                            const RenderSettings& settings, Sink& sink = nobody());

} // namespace pertev
