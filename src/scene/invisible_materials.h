#pragma once

// Detects materials that are invisible because they are fully transparent everywhere. Some exporters write `Tr 1` or
// an alpha of 0 for opaque surfaces, and the picture would be empty without any message.

#include <string>

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev {

/// Warns of each material whose opacity is 0 wherever a triangle uses it: by its own alpha, its textures' or the
/// vertices'. `scene` has passed validate().
void warn_of_invisible_materials(const Scene& scene, const std::string& file, Sink& sink);

} // namespace pertev
