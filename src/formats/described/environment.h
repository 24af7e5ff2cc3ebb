#pragma once

// Pictures of infinite lights as panoramas of a scene.

#include <optional>

#include "base/sink.h"
#include "formats/described/parts.h"
#include "image/image.h"
#include "math/double_transform.h"

namespace pertev::described {

/// Returns the environment of a light. `local_from_scene` leads from the directions of the scene to those of the
/// light. A picture that cannot be read is left out with a warning: nothing.
std::optional<Environment> make_environment(const InfiniteLight& light, const DoubleTransform& local_from_scene,
                                            Sink& sink);

} // namespace pertev::described
