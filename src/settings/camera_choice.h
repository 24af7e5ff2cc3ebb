#pragma once

// What is said of a camera; session/opening/choose_camera.h makes a camera of it. Messages call its fields by their
// names here.

#include <optional>
#include <string>

#include "math/double_vec3.h"
#include "math/vec3.h"
#include "scene/camera.h"

namespace pertev {

struct CameraChoice {
    std::string camera;                    // name or number, from 0, of one of the scene's; "": the first there is
    std::optional<DoubleVec3> eye, target; // metres, in the coordinates of the file
    std::optional<Vec3> up;
    bool is_aimed = false;         // the target is made up: aim_eye()
    std::optional<float> fov_deg;  // full vertical angle of view, degrees
    std::optional<float> aperture; // radius of the lens, metres
    std::optional<float> focus;    // distance in focus, metres
    std::optional<Projection> projection;
    std::optional<float> view_height; // of an orthographic view: its full height, metres
};

} // namespace pertev
