#pragma once

// What a file without light or without a camera gets, each with a notice.

#include "base/messages.h"
#include "scene/scene.h"

namespace pertev {

/// Gives a scene with something to be lit, but without lights (above 0), emissive materials or environment, a sky: 256
/// x 128 pixels, blue above, a broad warm sun from the upper left front. A white surface under it sends about 1.5 W/(sr
/// m2). In a closed room, where no light comes in, it is a row of lamps instead. The scene has been through validate().
void add_default_environment(Scene& scene, Messages& messages);

/// A camera that shows the scene: from outside in three-quarter view from above, through the open side of a stage, or
/// inside a room, at one end, looking along it. `aspect` = width / height of the picture. The scene has been through
/// validate().
Camera make_default_camera(const Scene& scene, float aspect, Messages& messages);

} // namespace pertev
