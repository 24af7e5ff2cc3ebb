#pragma once

// The default camera of a scene without one.

#include "base/sink.h"
#include "scene/scene.h"

namespace pertev {

/// Makes a camera that shows the scene, with a notice: from outside, a little to the side of +z and above, or from
/// where most of an object with culled backs is visible; through the open side of a stage; or inside a room, from one
/// end along it. `aspect` is width / height of the picture. The scene has passed validate().
Camera make_default_camera(const Scene& scene, float aspect, Sink& sink);

} // namespace pertev
