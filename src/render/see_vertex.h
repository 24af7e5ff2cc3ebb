#pragma once

// The camera's end of a light path: which place of the picture sees a point of the scene, through which point of the
// lens, and how densely the camera's rays go there. The camera's own rays (render/camera_view.h) backwards.

#include "render/camera_rays.h"

namespace pertev {

/// A point as the camera sees it.
struct SeenVertex {
    Vec3 from;      // on the lens (orthographic without one: in the camera's plane), world space
    Vec3 direction; // unit, from there to the point
    Vec2 raster;    // place in the picture, pixels from its upper left corner
    float density;  // of the camera's rays, were they even over the picture: 1/sr; orthographic 1/m2 across them
    float distance_squared; // m2; 1 where the rays are parallel
};

/// Density of the camera's rays along `direction` (unit), as SeenVertex has it.
HD inline float camera_density(const CameraRays& camera, Vec3 direction) {
    const float cosine = dot(direction, camera.axis);
    const float view = 4.0f * camera.view.half_width * camera.view.half_height;
    return has_parallel_rays(camera.view.projection) ? 1.0f / (view * cosine)
                                                     : 1.0f / (view * cosine * cosine * cosine);
}

/// False where `point` is not before the camera, or the camera is a light meter. `u`: of the lens.
HD inline bool see_vertex(const CameraRays& camera, Vec3 point, Vec2 u, SeenVertex& seen) {
    const CameraView& view = camera.view;
    const Vec3 local = transform_transposed(view.world_from_camera, point - view.world_from_camera.translation);
    const float depth = -local.z;
    if (!(depth > 0) || is_light_meter(view.projection)) return false;
    const Vec2 lens = camera.has_lens() ? view.aperture_radius * sample_uniform_disk_concentric(u) : Vec2{0, 0};
    float x, y; // in the plane at distance 1, or of the orthographic view
    Vec3 from = {lens.x, lens.y, 0};
    const bool is_parallel = has_parallel_rays(view.projection);
    if (!is_parallel) {
        x = local.x / depth;
        y = local.y / depth;
        if (camera.has_lens()) { // where the ray meets the plane in focus
            const float t = view.focus_distance / depth;
            x = (lens.x + t * (local.x - lens.x)) / view.focus_distance;
            y = (lens.y + t * (local.y - lens.y)) / view.focus_distance;
        }
    } else { // the rays through one point of the lens are parallel
        const float lean = camera.has_lens() ? depth / view.focus_distance : 0.0f;
        from = {local.x + lean * lens.x, local.y + lean * lens.y, 0};
        x = from.x - lens.x;
        y = from.y - lens.y;
    }
    seen.from = transform_point(view.world_from_camera, from);
    const Vec3 way = point - seen.from;
    const float distance_squared = length_squared(way);
    if (!(distance_squared > 0)) return false;
    seen.direction = way / sqrt(distance_squared);
    seen.raster = {(0.5f * x / view.half_width + 0.5f) * static_cast<float>(camera.width),
                   (0.5f - 0.5f * y / view.half_height) * static_cast<float>(camera.height)};
    const float reach = camera.filter.radius, right = static_cast<float>(camera.width) + reach,
                low = static_cast<float>(camera.height) + reach;
    if (!(seen.raster.x > -reach && seen.raster.x < right && seen.raster.y > -reach && seen.raster.y < low)) {
        return false;
    }
    seen.density = camera_density(camera, seen.direction);
    seen.distance_squared = is_parallel ? 1.0f : distance_squared;
    return seen.density > 0 && is_finite(seen.density);
}

} // namespace pertev
