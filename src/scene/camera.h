#pragma once

// A camera: at its local origin, looking along -z, +y up, +x right.

#include <cstdint>
#include <string>
#include <vector>

#include "base/host_device.h"
#include "math/rigid_motion.h"
#include "math/transform.h"
#include "scene/node_number.h"

namespace pertev {

/// Cosine is no view but a light meter (integrators/path/meter_light.h): rays from the origin over the hemisphere about
/// -z, their density the cosine over pi, over the picture from (0, 0) to (1, 1) as math/sampling.h has them.
enum class Projection : uint8_t { Perspective, Orthographic, Cosine };

/// Whether all rays of a picture go one way, so that nothing looks smaller for being far away.
HD constexpr bool has_parallel_rays(Projection projection) {
    switch (projection) {
    case Projection::Perspective:
    case Projection::Cosine:
        return false;
    case Projection::Orthographic:
        break;
    }
    return true;
}

/// Whether it measures light and shows nothing.
HD constexpr bool is_light_meter(Projection projection) {
    switch (projection) {
    case Projection::Perspective:
    case Projection::Orthographic:
        return false;
    case Projection::Cosine:
        break;
    }
    return true;
}

struct Camera {
    std::string name, origin;
    Projection projection = Projection::Perspective;
    Transform world_from_camera; // rigid; readers take scale out
    float fov_y = 0.785398163f;  // Perspective: full vertical angle, radians, (0, pi)
    float ortho_height = 2;      // Orthographic: full height of the view, metres
    float aspect = 0;            // width / height the file asks for; 0 = none
    float aperture_radius = 0;   // thin lens, metres; 0 = pinhole
    float focus_distance = 1;    // metres along -z to the plane in focus
    uint32_t node = kNoNode;     // index into Scene::nodes
    // While the shutter is open, about the origin, from where world_from_camera has it (math/rigid_motion.h), metres in
    // the world. Empty: it stands still.
    std::vector<MotionKey> motion;

    bool operator==(const Camera&) const = default;
};

/// Width / height of a picture of so many pixels.
inline float aspect_of(uint32_t width, uint32_t height) {
    return static_cast<float>(width) / static_cast<float>(height);
}

} // namespace pertev
