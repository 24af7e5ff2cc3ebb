#pragma once

// The camera at a time of a moving scene. What a choice of camera leaves open (the view of a scene without a camera,
// the target of an eye, the focus of a lens) is decided once in the scene at rest and stays. A camera of the scene
// moves with its node, a camera path moves the camera, and a turntable revolves it.

#include <optional>

#include "scene/camera_path.h"
#include "session/opening/choose_camera.h"

namespace pertev {

class MovingCamera {
public:
    /// Takes the scene at rest, which has passed validate(). With a `path`, `choice` names no eye, target or up. Throws
    /// as choose_camera.
    MovingCamera(CameraChoice choice, std::optional<CameraPath> path, const Scene& rest, float aspect, Sink& sink);

    /// Returns the camera at a time; `scene` is that of the constructor at this time. Without a time a path is at its
    /// first key. Throws Error(BadInput) if a path's eye and target coincide, or the target lies along up.
    Camera at(const Scene& scene, std::optional<double> time_s) const;

    /// The choice that gives at(scene, time_s) again, as text, with everything that was left open.
    CameraChoice choice_at(std::optional<double> time_s) const;

    /// `camera` after a fraction `turn` of a revolution around the vertical (+y) through its target: the choice's, a
    /// default camera's, or the middle of the scene at rest. Counter-clockwise from above.
    Camera turned(const Camera& camera, double turn) const;

private:
    CameraChoice choice_; // completed, except for the positions of the scene's own camera
    std::optional<CameraPath> path_;
    std::optional<Camera> made_up_; // for a scene without camera and a choice without eye
    float aspect_;
    Vec3 middle_; // centre of turned(), in the scene's coordinates
};

} // namespace pertev
