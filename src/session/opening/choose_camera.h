#pragma once

// From what is said of a camera (a name, an eye, a lens) to a camera: what is left open comes from the scene's own, or
// from what there is to see. The fields below are called after the settings.

#include <string>

#include "base/messages.h"
#include "scene/scene.h"
#include "settings/camera_choice.h"

namespace pertev {

/// What can be told before the scene is read. Throws Error(BadInput) for a part of the choice that another one makes
/// useless.
void check_camera_choice(const CameraChoice& choice);

/// The scene's own camera: the one that is named, else the first, else null. Throws Error(BadInput) that lists those
/// there are when none is named so.
const Camera* scene_camera(const std::string& name, const Scene& scene);

/// Gives an eye without a target one, the middle of the scene, with a notice. choose_camera() does so, too; this is for
/// those who record what was looked at.
void aim_eye(CameraChoice& choice, const Scene& scene, Messages& messages);

/// The camera that the choice or the scene or the defaults give, for a picture of this width / height. A part of the
/// choice that this camera makes useless is a warning. The scene has been through validate(). Throws Error(BadInput).
Camera choose_camera(CameraChoice choice, const Scene& scene, float aspect, Messages& messages);

} // namespace pertev
