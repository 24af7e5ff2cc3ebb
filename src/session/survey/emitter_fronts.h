#pragma once

// Reports which emitters of a scene emit only from their fronts, for file formats that cannot state it, and which of
// them seem to be turned the wrong way round.

#include <string>

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev {

/// Adds a notice that names the emitters, and a warning for each that has a wall right in front and empty space behind
/// it: up to the next surface or, without any, most of the scene's box. Nothing is added if no emitter is one-sided.
/// `file` begins the messages. The scene has passed validate().
void report_emitter_fronts(const Scene& scene, const std::string& file, Sink& sink);

} // namespace pertev
