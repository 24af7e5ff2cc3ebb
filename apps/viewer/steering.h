#pragma once

// Steps of the camera, defined only here: pure functions from one pose to the next. A pose has the form of the
// command line (eye, target, up), from which look_at makes exactly the camera that `pertev render` makes of its
// flags, so that a view can be copied from the viewer to a render with bit-identical pictures. Lengths are in metres,
// angles in radians, drags in picture heights.

#include <optional>
#include <string>

#include "apps/viewer/client_message.h"
#include "math/double_vec3.h"
#include "scene/camera.h"
#include "session/degrees.h"

namespace pertev {

struct Pose { // in the scene's coordinates
    Vec3 eye, target, up;
    Vec3 centre; // centre of the orbit
    bool operator==(const Pose&) const = default;
};

/// The pose of a camera. `target` and `up` are used if requested; otherwise the target is `distance` ahead, and up is
/// +y or, for a rolled camera, its own.
Pose pose_of(const Camera& camera, std::optional<Vec3> target, std::optional<Vec3> up, float distance);
/// `lens` placed at the pose. The focus distance is kept, except for a pinhole, which focuses on its target.
Camera camera_at(const Pose& pose, const Camera& lens);

/// Moves along the view's own axes, together with the target and the orbit's centre.
Pose fly(const Pose& pose, float right, float up, float forward);
/// Rotates around the centre; stops short of straight up and down. A drag of the picture's height is half a turn.
Pose orbit(const Pose& pose, float dx, float dy);
/// Rotates around the eye by the dragged angle of the view. The centre becomes the target. `fov_y` is that of the
/// view.
Pose turn(const Pose& pose, float dx, float dy, float fov_y);
/// Moves across the view, so that points at the centre's distance, where the view has this height, follow the pointer.
Pose pan(const Pose& pose, float dx, float dy, float view_height);
/// Moves towards the centre, or away from it: a step is a seventh of the distance, so it is never reached.
Pose zoom(const Pose& pose, float steps);

/// Distance in metres of `message`, a Move, at `speed` metres per second.
float metres_of(const ClientMessage& message, float speed);

/// The flags of pertev render that reproduce this camera: --eye --target --up, and the lens if it differs from their
/// defaults. `name` is the value of --camera, or empty. `origin` is the scene's origin in its file.
std::string camera_flags(const Pose& pose, const Camera& camera, const std::string& name,
                         DoubleVec3 origin = {0, 0, 0});
/// Flags for the scene's camera `name` at its own position, with the lens of `camera`.
std::string scene_camera_flags(const Camera& camera, const std::string& name);

/// A one-pixel camera without a lens that looks through the position (x, y) of the picture of `camera`, [0, 1] each
/// from the upper left. Its depth is the distance along that ray.
Camera camera_through(const Camera& camera, float aspect, float x, float y);

} // namespace pertev
