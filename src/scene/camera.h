#pragma once

// A camera: at its local origin, looking along -z, +y up, +x right.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/host_device.h"
#include "math/rigid_motion.h"
#include "math/transform.h"
#include "scene/lens_model.h"
#include "scene/node_number.h"

namespace pertev {

/// Kind of projection. Cosine is not a view but a light meter (integrators/path/meter_light.h): its rays cover the
/// hemisphere around -z with density cosine over pi, mapped from the picture's (0, 0) to (1, 1) as in
/// math/sampling.h.
enum class Projection : uint8_t { Perspective, Orthographic, Cosine };

/// Returns whether all rays are parallel, so that apparent size does not depend on distance.
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

/// Returns whether a projection measures light instead of showing a picture.
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

/// A calibrated view: focal lengths and principal point in pixels of a picture of `width` x `height` pixels, from its
/// upper left corner. In a picture of another size both scale with width and height.
struct Intrinsics {
    double focal_x, focal_y, centre_x, centre_y;
    uint32_t width, height;
    bool operator==(const Intrinsics&) const = default;
};

/// The fewest and most blades of an aperture that is no disk.
inline constexpr uint32_t kMinBlades = 3, kMaxBlades = 100;
inline constexpr float kMinApertureRatio = 0.01f, kMaxApertureRatio = 100;
inline constexpr float kMaxApertureRotation = 1e6f; // degrees, either way
constexpr bool is_blade_count(uint32_t blades) { return blades == 0 || (blades >= kMinBlades && blades <= kMaxBlades); }

/// The shape of a thin lens's aperture, as Cycles defines it: inscribed in the circle of the aperture's radius, and
/// then divided in its width by `ratio`. The camera looks at it from behind, with +x to the right and +y up.
struct ApertureShape {
    uint32_t blades = 0;    // sides of a regular polygon; 0: a disk
    float rotation_deg = 0; // counter-clockwise; at 0 the middle of a side lies towards +x
    float ratio = 1;        // height over width, in [kMinApertureRatio, kMaxApertureRatio]
    bool operator==(const ApertureShape&) const = default;
};

struct Camera {
    std::string name, origin;
    Projection projection = Projection::Perspective;
    Transform world_from_camera;          // rigid; readers remove scale
    float fov_y = 0.785398163f;           // Perspective: full vertical angle, radians, (0, pi)
    float ortho_height = 2;               // Orthographic: full height of the view, metres
    std::optional<Intrinsics> intrinsics; // Perspective: in place of fov_y, which is about the same
    LensModel lens = LensModel::Straight; // Perspective
    std::vector<double> distortion;       // coefficients in the lens's order, at most 8; those that lack are 0
    float aspect = 0;                     // width / height in the file; 0: none
    float aperture_radius = 0;            // thin lens, metres; 0 = pinhole
    ApertureShape aperture;
    float focus_distance = 1; // metres along -z to the plane in focus
    uint32_t node = kNoNode;  // index into Scene::nodes
    // Motion while the shutter is open, around the origin, relative to world_from_camera (math/rigid_motion.h),
    // metres in the world. Empty: the camera does not move.
    std::vector<MotionKey> motion;

    bool operator==(const Camera&) const = default;
};

/// Aspect ratio, width / height, of a picture.
inline float aspect_of(uint32_t width, uint32_t height) {
    return static_cast<float>(width) / static_cast<float>(height);
}

} // namespace pertev
