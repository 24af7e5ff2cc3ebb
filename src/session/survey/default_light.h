#pragma once

// The light of a scene that has none.

#include "base/messages.h"
#include "scene/scene.h"

namespace pertev {

enum class DefaultLight { None, Sky, Lamps }; // None: the scene has light, or nothing to be lit

/// Gives a scene with something to be lit, but without lights (above 0), emissive materials or environment, a sky: 256
/// x 128 pixels, blue above, a broad warm sun from the upper left front. A white surface under it sends about 1.5 W/(sr
/// m2). In a closed room, where no light comes in, it is a row of lamps instead. A notice tells of it. The scene has
/// been through validate().
DefaultLight add_default_light(Scene& scene, Messages& messages);

} // namespace pertev
