#pragma once

// The part of validate() for materials, images and the environment.

#include <string>

#include "base/messages.h"
#include "scene/scene.h"

namespace pertev {

/// Clamps values to their ranges with a warning; throws Error(BadInput or OverLimit) for numbers that are not finite
/// and for indices out of range. Pixels that are not finite, or negative light, become 0, with a warning that counts
/// them.
void validate_materials(Scene& scene, const std::string& file, Messages& messages);

} // namespace pertev
