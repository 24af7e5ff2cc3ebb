#pragma once

// The camera of a scene that has none.

#include "base/messages.h"
#include "scene/scene.h"

namespace pertev {

/// A camera that shows the scene: from outside, a little to the side of +z and above, or from where most is seen of
/// what hides its backs; through the open side of a stage; or inside a room, at one end, looking along it; with a
/// notice. `aspect` = width / height of the picture. The scene has been through validate().
Camera make_default_camera(const Scene& scene, float aspect, Messages& messages);

} // namespace pertev
