#pragma once

// validate()'s part for materials, images and the environment.

#include <string>

#include "base/messages.h"
#include "scene/scene.h"

namespace pertev {

/// Clamps what has a range, with a warning; throws Error(BadInput or OverLimit) for what is not finite or out of range
/// as an index. Pixels that are not finite, or negative light, become 0, with a warning that counts them.
void validate_materials(Scene& scene, const std::string& file, Messages& messages);

} // namespace pertev
