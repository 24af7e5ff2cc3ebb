#pragma once

// Says which lamps of a scene shine from their fronts alone, for files that have no way to tell, and which of them
// look as if they were turned the wrong way round.

#include <string>

#include "base/messages.h"
#include "scene/scene.h"

namespace pertev {

/// A notice that names the lamps, and a warning for each that has a wall right before its front and room behind it: up
/// to the next surface or, without any, most of the scene's box.
/// Nothing where no lamp is one-sided. `file` begins the messages. The scene has been through validate().
void say_lamp_fronts(const Scene& scene, const std::string& file, Messages& messages);

} // namespace pertev
