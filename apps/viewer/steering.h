#pragma once

// Steps of the camera, the one place for them: pure functions from one pose to the next. A pose is kept in the words of
// the command line (eye, target, up), of which look_at makes the very camera that `pertev render` makes of its flags:
// so a view can be taken from the viewer to a render, and the pictures are the same to the bit. Lengths are metres,
// angles radians; a drag is given in heights of the picture.

#include <optional>
#include <string>

#include "apps/viewer/client_message.h"
#include "math/double_vec3.h"
#include "scene/camera.h"
#include "session/degrees.h"

namespace pertev {

struct Pose { // in the scene's coordinates
    Vec3 eye, target, up;
    Vec3 centre; // of the orbit
    bool operator==(const Pose&) const = default;
};

/// The pose of a camera. `target`, `up`: where they were asked for; else `distance` ahead, and +y or, for a camera that
/// leans, its own.
Pose pose_of(const Camera& camera, std::optional<Vec3> target, std::optional<Vec3> up, float distance);
/// `lens` placed at the pose. What is in focus stays as far away, but for a pinhole, which has it at its target.
Camera camera_at(const Pose& pose, const Camera& lens);

/// Along the view's own axes. The target and the orbit's centre go along.
Pose fly(const Pose& pose, float right, float up, float forward);
/// About the centre; stops short of straight up and down. Full height of the picture: half a turn.
Pose orbit(const Pose& pose, float dx, float dy);
/// Turns about the eye by what the drag covers of the view. The centre is then the target. `fov_y`: of the view.
Pose look(const Pose& pose, float dx, float dy, float fov_y);
/// Across the view, so that what lies at the centre's distance follows the pointer. `view_height`: of the picture at
/// distance 1, or of an orthographic view.
Pose pan(const Pose& pose, float dx, float dy, float view_height, bool is_orthographic);
/// To the centre, or away from it: a step is a seventh of the distance. Never reaches it.
Pose zoom(const Pose& pose, float steps);

/// Metres for `message`, a Move, at `speed` metres a second.
float metres_of(const ClientMessage& message, float speed);

/// The flags of pertev render that place this camera: --eye --target --up, and the lens, as far as it is not what they
/// leave as it is. `name`: of --camera; empty for none. `origin`: of the scene, in its file.
std::string camera_flags(const Pose& pose, const Camera& camera, const std::string& name,
                         DoubleVec3 origin = {0, 0, 0});
/// The same of the scene's camera `name`, where it stands, with the lens of `camera`.
std::string scene_camera_flags(const Camera& camera, const std::string& name);

/// A camera of one pixel that looks through the place (x, y) of the picture of `camera`, [0, 1] each from the upper
/// left: without a lens. Its depth is the distance along that ray.
Camera camera_through(const Camera& camera, float aspect, float x, float y);

} // namespace pertev
