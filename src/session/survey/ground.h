#pragma once

// A ground under an object in the generated studio: it receives the object's soft shadow and is invisible otherwise.

#include "scene/scene.h"

namespace pertev {

/// Adds a disc beneath the scene's box, as the last instance (Instance::is_background), mesh and material. Unshadowed
/// it looks like the studio's floor, and it fades out towards its rim. Camera rays pass through its lower side. Does
/// nothing if the box is empty. The scene has passed validate().
void add_ground(Scene& scene);

/// Returns whether add_ground() has added a ground to the scene.
bool has_ground(const Scene& scene);

} // namespace pertev
