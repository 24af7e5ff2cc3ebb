#pragma once

// What the camera flags leave open: where --eye alone looks, and what --aperture alone focuses on.

#include "apps/cli/scene_options.h"

namespace pertev {

/// Where --eye stands without --target, gives `options` a target, the middle of the scene, with a notice. Throws
/// Error(BadInput).
void aim_eye(SceneOptions& options, const Scene& scene, Messages& messages);

/// Where --aperture stands without --focus and --target, focuses `camera`, which is placed, on what is in the middle of
/// its picture, or else on the distance of the scene's middle, with a notice.
void focus_in_the_middle(const SceneOptions& options, const Scene& scene, Camera& camera, Messages& messages);

} // namespace pertev
