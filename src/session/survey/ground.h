#pragma once

// A ground under a thing that stands in the made-up studio: it catches the thing's soft shadow and is not seen
// otherwise.

#include "scene/scene.h"

namespace pertev {

/// Adds a disc beneath the scene's box, as the last instance (Instance::is_background), mesh and material. Where
/// nothing stands in its light it looks as the studio's floor does, and it fades out towards its rim. Its lower side
/// lets rays of the camera pass. Does nothing where the box is empty. The scene has been through validate().
void add_ground(Scene& scene);

/// Whether the scene has such a ground.
bool has_ground(const Scene& scene);

} // namespace pertev
