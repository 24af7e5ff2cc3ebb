#pragma once

// The medium that a setting puts around everything, from text such as "sigma_s=0.1,0.2,0.3 sigma_a=0.01 g=0.5".

#include <string>

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev {

/// Parses coefficients in 1/m, each R,G,B or one number for all three, and the anisotropy g; "none" is a vacuum. Throws
/// Error(BadInput).
MediumParameters parse_medium(const std::string& text);

/// Replaces the scene's medium unless `text` is empty. Warns of lights that a medium without end hides.
void set_medium(const std::string& text, Scene& scene, Sink& sink);

} // namespace pertev
