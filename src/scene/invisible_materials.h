#pragma once

// Materials that nobody can see, because they let all light through everywhere. Some exporters write `Tr 1` or an alpha
// of 0 for opaque surfaces, and the picture is then empty without a word.

#include <string>

#include "base/messages.h"
#include "scene/scene.h"

namespace pertev {

/// Names each material, in a warning, whose opacity is 0 wherever a triangle has it: by its own alpha, by that of its
/// textures, or by that of the vertices. `scene` has been through validate().
void warn_of_invisible_materials(const Scene& scene, const std::string& file, Messages& messages);

} // namespace pertev
