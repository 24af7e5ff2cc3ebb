#pragma once

// The camera's end of a light path: the picture position that sees a point of the scene through a given point of the
// lens, and the density of camera rays there. It inverts the camera rays of render/camera_view.h.

#include "render/camera_rays.h"

namespace pertev {

/// A point as the camera sees it.
struct CameraConnection {
    Vec3 from;      // on the lens, or in the camera's plane for an orthographic camera without one; world space
    Vec3 direction; // unit, from there to the point
    Vec2 raster;    // position in the picture, pixels from its upper left corner
    float density;  // density of camera rays if they were uniform over the picture: 1/sr; orthographic 1/m2 across
                    // them
    float distance_squared; // m2; 1 if the rays are parallel
};

/// Returns whether the density of camera rays at a point is that of CameraConnection over its squared distance.
HD inline bool falls_with_distance(const CameraRays& camera) { return !has_parallel_rays(camera.view.projection); }

/// Density of camera rays along `direction` (unit) from `origin`, as in CameraConnection; 0 if there are none.
HD inline float camera_density(const CameraRays& camera, Vec3 origin, Vec3 direction) {
    const CameraView& view = camera.view;
    const float cosine = dot(direction, camera.axis);
    const float area = 4.0f * view.half_width * view.half_height;
    if (!falls_with_distance(camera)) return 1.0f / (area * cosine);
    const float of_straight = 1.0f / (area * cosine * cosine * cosine);
    if (view.lens.is_straight()) return of_straight;
    Vec3 local = transform_transposed(view.world_from_camera, direction);
    if (camera.has_lens()) { // the direction to the ray's point in focus from the middle of the lens
        const Vec3 lens = transform_transposed(view.world_from_camera, origin - view.world_from_camera.translation);
        local = {lens.x - view.focus_distance * local.x / local.z, lens.y - view.focus_distance * local.y / local.z,
                 -view.focus_distance};
    }
    const LensProjection through = project_through_lens(view.lens, local);
    if (!through.is_seen) return 0.0f;
    return view.lens.sees_behind() ? through.growth / area : through.growth * of_straight;
}

/// Projects `point` through the lens point `u`. Returns false if it is not in front of the camera, or if the camera
/// is a light meter.
HD inline bool connect_to_camera(const CameraRays& camera, Vec3 point, Vec2 u, CameraConnection& seen) {
    const CameraView& view = camera.view;
    const Vec3 local = transform_transposed(view.world_from_camera, point - view.world_from_camera.translation);
    const float depth = -local.z;
    if (!(depth > 0 || view.lens.sees_behind()) || camera.is_meter()) return false;
    const Vec2 lens = camera.has_lens() ? sample_aperture(view, u) : Vec2{0, 0};
    float x, y; // in the plane at distance 1, or in the orthographic view
    Vec3 from = {lens.x, lens.y, 0};
    const bool is_parallel = !falls_with_distance(camera);
    if (!is_parallel) {
        x = local.x / depth;
        y = local.y / depth;
        if (camera.has_lens()) { // intersection of the ray with the plane in focus
            const float t = view.focus_distance / depth;
            x = (lens.x + t * (local.x - lens.x)) / view.focus_distance;
            y = (lens.y + t * (local.y - lens.y)) / view.focus_distance;
        }
    } else { // all rays through one point of the lens are parallel
        const float lean = camera.has_lens() ? depth / view.focus_distance : 0.0f;
        from = {local.x + lean * lens.x, local.y + lean * lens.y, 0};
        x = from.x - lens.x;
        y = from.y - lens.y;
    }
    if (!view.lens.is_straight()) {
        const LensProjection through =
            project_through_lens(view.lens, view.lens.sees_behind() ? local : Vec3{x, y, -1});
        if (!through.is_seen) return false;
        x = through.at.x;
        y = through.at.y;
    }
    seen.from = transform_point(view.world_from_camera, from);
    const Vec3 offset = point - seen.from;
    const float distance_squared = length_squared(offset);
    if (!(distance_squared > 0)) return false;
    seen.direction = offset / sqrt(distance_squared);
    seen.raster = {(0.5f * x / view.half_width + 0.5f * view.centre.x) * static_cast<float>(camera.width),
                   (0.5f * view.centre.y - 0.5f * y / view.half_height) * static_cast<float>(camera.height)};
    const float reach = camera.filter.radius, right = static_cast<float>(camera.width) + reach,
                low = static_cast<float>(camera.height) + reach;
    if (!(seen.raster.x > -reach && seen.raster.x < right && seen.raster.y > -reach && seen.raster.y < low)) {
        return false;
    }
    seen.density = camera_density(camera, seen.from, seen.direction);
    seen.distance_squared = is_parallel ? 1.0f : distance_squared;
    return seen.density > 0 && is_finite(seen.density);
}

} // namespace pertev
