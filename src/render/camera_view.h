#pragma once

// A camera as device code has it: rays (pinhole, thin lens and orthographic), and where it sees a point; what rays
// through a lens see is in render/see_vertex.h. Nobody but these files asks what kind of camera it is. A pixel position
// is in pixels from the picture's upper left corner.

#include <cstdint>

#include "base/host_device.h"
#include "math/sampling.h"
#include "math/transform.h"
#include "math/vec2.h"
#include "scene/camera.h"
#include "trace/intersect/ray.h"

namespace pertev {

struct CameraView {
    Transform world_from_camera;
    Projection projection;
    float half_width, half_height; // of the view: at distance 1 (perspective) or in metres (orthographic)
    float inv_width, inv_height;   // 1 / pixels
    float aperture_radius;         // metres
    float focus_distance;          // metres
};

/// `fov_y` etc. of the camera with the picture's own shape: the height keeps its angle, the width follows. `centre`:
/// the origin of the world that its rays go into, in the camera's coordinates.
CameraView make_camera_view(const Camera& camera, uint32_t width, uint32_t height, Vec3 centre = {0, 0, 0});

/// Place of `pixel` in the view, x to the right and y up, in units of half_width's.
HD inline Vec2 place_in_view(const CameraView& camera, Vec2 pixel) {
    return {(2.0f * (pixel.x * camera.inv_width) - 1.0f) * camera.half_width,
            (1.0f - 2.0f * (pixel.y * camera.inv_height)) * camera.half_height};
}

/// What the view grows by at `depth`: what lies there is seen so many times smaller.
HD inline float growth_at(const CameraView& camera, float depth) {
    return has_parallel_rays(camera.projection) ? 1.0f : depth;
}

/// Ray through `pixel`, starting on the lens at `lens` (unit square). Unit direction.
HD inline Ray make_camera_ray(const CameraView& camera, Vec2 pixel, Vec2 lens) {
    const Vec2 at = place_in_view(camera, pixel);
    Vec3 origin = {0, 0, 0}, direction = {at.x, at.y, -1};
    switch (camera.projection) {
    case Projection::Perspective:
        break;
    case Projection::Orthographic:
        origin = {at.x, at.y, 0};
        direction = {0, 0, -1};
        break;
    case Projection::Cosine: {
        const Vec3 about_z = sample_cosine_hemisphere({pixel.x * camera.inv_width, pixel.y * camera.inv_height});
        direction = {about_z.x, about_z.y, -about_z.z};
    }
    }
    if (camera.aperture_radius > 0) {
        const Vec2 on_lens = camera.aperture_radius * sample_uniform_disk_concentric(lens);
        const Vec3 focus = origin + camera.focus_distance * direction; // z = -focus_distance
        origin = {origin.x + on_lens.x, origin.y + on_lens.y, 0};
        direction = focus - origin;
    }
    return {transform_point(camera.world_from_camera, origin), 0.0f,
            normalize(transform_vector(camera.world_from_camera, direction)), kInfinity};
}

/// Where a camera sees a point: pixels from the picture's upper left corner, and metres along its axis.
struct SeenPoint {
    Vec2 pixel;
    float depth;
};

/// A pinhole's view of `point`, world space. Of a point behind a perspective camera (depth <= 0) the pixel says
/// nothing.
HD inline SeenPoint see_point(const CameraView& camera, Vec3 point) {
    const Vec3 local = transform_transposed(camera.world_from_camera, point - camera.world_from_camera.translation);
    const float depth = -local.z;
    const float scale = 1.0f / growth_at(camera, depth);
    return {{(0.5f * (scale * local.x) / camera.half_width + 0.5f) / camera.inv_width,
             (0.5f - 0.5f * (scale * local.y) / camera.half_height) / camera.inv_height},
            depth};
}

/// The point of the camera's own space that a pinhole sees at `pixel` and `depth`.
HD inline Vec3 point_seen(const CameraView& camera, Vec2 pixel, float depth) {
    const Vec2 at = place_in_view(camera, pixel);
    const float scale = growth_at(camera, depth);
    return {scale * at.x, scale * at.y, -depth};
}

/// Whether a point at `depth` is where see_point has it: before the camera, or seen by parallel rays.
HD inline bool is_projected(const CameraView& camera, float depth) {
    return depth > 0 || has_parallel_rays(camera.projection);
}

/// Metres of the world that a pixel's side shows at `depth`.
HD inline float pixel_size(const CameraView& camera, float depth) {
    return 2.0f * camera.half_height * camera.inv_height * growth_at(camera, depth);
}

} // namespace pertev
