#pragma once

// Requested properties of a camera, from which session/opening/choose_camera.h makes one. Messages use the names of
// the fields.

#include <optional>
#include <string>

#include "math/double_vec3.h"
#include "math/vec3.h"
#include "scene/camera.h"

namespace pertev {

struct CameraChoice {
    std::string camera;                    // name or number, from 0, of a camera of the scene; "": the first
    std::optional<DoubleVec3> eye, target; // metres, in the coordinates of the file
    std::optional<Vec3> up;
    bool is_aimed = false;         // whether aim_camera() has set the target
    std::optional<float> fov_deg;  // full vertical field of view, degrees
    std::optional<float> aperture; // radius of the lens, metres
    std::optional<float> focus;    // focus distance, metres
    std::optional<Projection> projection;
    std::optional<float> view_height; // full height of an orthographic view, metres
};

} // namespace pertev
