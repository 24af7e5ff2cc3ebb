#pragma once

// Makes a camera from the settings (a name, an eye, a lens). What these leave open comes from the scene's own camera,
// or from the scene's contents. The fields below have the names of the settings.

#include <string>

#include "base/sink.h"
#include "scene/scene.h"
#include "settings/camera_choice.h"

namespace pertev {

/// The scene's own camera: the named one, else the first, else null. Throws Error(BadInput) with a list of the
/// cameras if none has that name.
const Camera* scene_camera(const std::string& name, const Scene& scene);

/// Gives an eye without a target the middle of the scene as its target, with a notice. choose_camera() does so too;
/// this is for those who record the target.
void aim_camera(CameraChoice& choice, const Scene& scene, Sink& sink);

/// The camera from the choice, the scene or the defaults, for a picture with the aspect ratio width / height. A part
/// of the choice without effect on this camera gives a warning. The scene has passed validate(). Throws
/// Error(BadInput).
Camera choose_camera(CameraChoice choice, const Scene& scene, float aspect, Sink& sink);

} // namespace pertev
