#pragma once

// Instances that a caller wants to move often. Each keeps a BLAS, also if its mesh is used once, so that
// moving it rebuilds only the TLAS.

#include <span>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace pertev {

/// Returns whether each instance has one of these names (scene/names.h); empty without names. Throws Error(BadInput)
/// for a name that none has.
std::vector<bool> movable_instances(std::span<const std::string> names, const Scene& scene);

} // namespace pertev
