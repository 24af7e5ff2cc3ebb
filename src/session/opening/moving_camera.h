#pragma once

// Where the camera is at a time of a scene that moves. What a choice of camera leaves open (a view of a scene without a
// camera, what an eye looks at, what a lens focuses on) is decided once, in the scene at rest, and stays; a camera of
// the scene's own goes with its node, a path leads the camera, a turntable takes it round.

#include <optional>

#include "scene/camera_path.h"
#include "session/opening/choose_camera.h"

namespace pertev {

class MovingCamera {
public:
    /// `rest`: the scene at rest, which has been through validate(). `path`: then `choice` names no eye, target or up.
    /// Throws as choose_camera.
    MovingCamera(CameraChoice choice, std::optional<CameraPath> path, const Scene& rest, float aspect,
                 Messages& messages);

    /// `scene`: the one at rest, as it is at the time. Without a time a path is at its first key. Throws
    /// Error(BadInput) where a path's eye and target meet, or the target lies along up.
    Camera at(const Scene& scene, std::optional<double> time_s) const;

    /// The choice that gives at(scene, time_s) again: its texts for people, with what was left open.
    CameraChoice choice_at(std::optional<double> time_s) const;

    /// `camera` after a share `turn` of a whole turn about the vertical (+y) through what it looks at: the choice's
    /// target, what a made-up camera looks at, else the middle of the scene at rest. Counter-clockwise seen from above.
    Camera turned(const Camera& camera, double turn) const;

private:
    CameraChoice choice_; // nothing left open but for places that the scene's own camera has
    std::optional<CameraPath> path_;
    std::optional<Camera> made_up_; // the scene has none, and the choice no eye
    float aspect_;
    Vec3 middle_; // of turned(); in the scene's coordinates
};

} // namespace pertev
