#pragma once

// The device form of a camera: its rays (pinhole, thin and distorting lens, orthographic) and the
// projection of points; render/connect_to_camera.h projects through the lens. Only these files and
// render/lens_distortion.h distinguish kinds of cameras. A pixel position is in pixels from the picture's upper left
// corner.

#include <cstdint>

#include "base/host_device.h"
#include "math/sampling.h"
#include "math/transform.h"
#include "math/vec2.h"
#include "render/lens_distortion.h"
#include "scene/camera.h"
#include "trace/intersect/ray.h"

namespace pertev {

struct CameraView {
    Transform world_from_camera;
    Projection projection;
    float half_width, half_height; // half size of the view at distance 1 (perspective) or in metres (orthographic)
    float inv_width, inv_height;   // 1 / pixels
    float aperture_radius;         // metres
    float aperture_width;          // half the width of the aperture's circle, or of its ellipse; metres
    RegularPolygon blades;         // the aperture in its circle; without sides: a disk
    float focus_distance;          // metres
    Vec2 centre;                   // where the axis meets the picture, in halves of its width and height: usually 1, 1
    LensView lens;
};

/// The origin of a camera ray that does not exist, because the lens images nothing at that picture position. The ray
/// lies outside of every scene, so it hits nothing and has no light.
inline constexpr float kNowhere = 0x1p44f;
HD inline bool is_outside_lens(Vec3 origin) { return max_component(abs(origin)) > 0x1p42f; }

/// Half the height of the view: at distance 1, or in metres for parallel rays.
float half_view_height(const Camera& camera);

/// Fits the camera's view to the aspect ratio of the picture: the vertical angle is kept and the width follows.
/// `centre` is the origin of the rays' world in the camera's coordinates.
CameraView make_camera_view(const Camera& camera, uint32_t width, uint32_t height, Vec3 centre = {0, 0, 0});

/// Position of `pixel` in the view, x to the right and y up, in the unit of half_width.
template <class T = float>
HD inline Vec2Of<T> view_position(const CameraView& camera, Vec2Of<T> pixel) {
    return {(2.0f * (pixel.x * camera.inv_width) - camera.centre.x) * camera.half_width,
            (camera.centre.y - 2.0f * (pixel.y * camera.inv_height)) * camera.half_height};
}
/// The pixel position of a point of the view.
HD inline Vec2 pixel_at(const CameraView& camera, Vec2 at) {
    return {(0.5f * at.x / camera.half_width + 0.5f * camera.centre.x) / camera.inv_width,
            (0.5f * camera.centre.y - 0.5f * at.y / camera.half_height) / camera.inv_height};
}

/// Scale of a view as a function of depth: objects there appear smaller by this factor.
struct ViewGrowth {
    bool is_constant;
    HD float at(float depth) const { return is_constant ? 1.0f : depth; }
};
HD inline ViewGrowth growth_of(const CameraView& camera) { return {has_parallel_rays(camera.projection)}; }
HD inline float growth_at(const CameraView& camera, float depth) { return growth_of(camera).at(depth); }

/// The point `u` (unit square) of a lens with an aperture, uniform by area; metres from its middle.
template <class T>
HD inline Vec2Of<T> sample_aperture(const CameraView& camera, Vec2Of<T> u) {
    const Vec2Of<T> at =
        camera.blades.sides > 0 ? sample_regular_polygon(camera.blades, u) : sample_uniform_disk_concentric(u);
    return {camera.aperture_width * at.x, camera.aperture_radius * at.y};
}

/// Start and direction of the ray through `pixel` from the point `lens` (unit square) of the lens.
template <class T>
HD inline RayLineOf<T> make_camera_line(const CameraView& camera, Vec2Of<T> pixel, Vec2Of<T> lens) {
    const Vec2Of<T> at = view_position(camera, pixel);
    Vec3Of<T> origin = {0, 0, 0}, direction = {at.x, at.y, -1};
    MaskOf<T> is_seen = true;
    switch (camera.projection) {
    case Projection::Perspective:
        if (!camera.lens.is_straight()) {
            const SeenThroughLens<T> seen =
                seen_through_lens(camera.lens, at, 0x1p-5f * (camera.inv_width * camera.half_width));
            direction = seen.direction;
            is_seen = seen.is_seen;
        }
        break;
    case Projection::Orthographic:
        origin = {at.x, at.y, 0};
        direction = {0, 0, -1};
        break;
    case Projection::Cosine: {
        const Vec3Of<T> about_z =
            sample_cosine_hemisphere(Vec2Of<T>{pixel.x * camera.inv_width, pixel.y * camera.inv_height});
        direction = {about_z.x, about_z.y, -about_z.z};
    }
    }
    if (camera.aperture_radius > 0) {
        const Vec2Of<T> on_lens = sample_aperture(camera, lens);
        const Vec3Of<T> focus = origin + camera.focus_distance * direction; // z = -focus_distance
        origin = {origin.x + on_lens.x, origin.y + on_lens.y, 0};
        direction = focus - origin;
    }
    const auto world_from_camera = for_lanes<T>(camera.world_from_camera);
    const Vec3Of<T> from = transform_point(world_from_camera, origin),
                    towards = normalize(transform_vector(world_from_camera, direction));
    if (camera.lens.is_straight()) return {from, towards};
    const T nowhere = kNowhere, diagonal = 0x1.279a74p-1f;
    return {select(is_seen, from, {nowhere, nowhere, nowhere}),
            select(is_seen, towards, {diagonal, diagonal, diagonal})};
}

/// The camera ray through `pixel`, unbounded.
HD inline Ray make_camera_ray(const CameraView& camera, Vec2 pixel, Vec2 lens) {
    const RayLine line = make_camera_line(camera, pixel, lens);
    return {line.origin, 0.0f, line.direction, kInfinity};
}

/// Projection of a point: pixels from the picture's upper left corner, and metres along the camera's axis.
struct ProjectedPoint {
    Vec2 pixel;
    float depth;
};

/// Projects `point` (world space) through the middle of the lens. The pixel is meaningless for a point behind a
/// perspective camera (depth <= 0), and NaN for one that a distorting lens does not show.
HD inline ProjectedPoint project_point(const CameraView& camera, Vec3 point) {
    const Vec3 local = transform_transposed(camera.world_from_camera, point - camera.world_from_camera.translation);
    const float depth = -local.z;
    const float scale = 1.0f / growth_at(camera, depth);
    Vec2 at = {scale * local.x, scale * local.y};
    if (!camera.lens.is_straight()) {
        const LensProjection through = project_through_lens(camera.lens, local);
        at = through.is_seen ? through.at : Vec2{float_of(0x7fc00000u), float_of(0x7fc00000u)};
    }
    return {pixel_at(camera, at), depth};
}

/// The point in camera space that a camera with a straight lens sees at `pixel` and `depth`.
HD inline Vec3 unproject_point(const CameraView& camera, Vec2 pixel, float depth) {
    const Vec2 at = view_position(camera, pixel);
    const float scale = growth_at(camera, depth);
    return {scale * at.x, scale * at.y, -depth};
}

/// Returns whether project_point is valid at `depth`: in front of the camera, or for an orthographic camera or a
/// lens that sees behind.
HD inline bool is_projected(const CameraView& camera, float depth) {
    return depth > 0 || has_parallel_rays(camera.projection) || camera.lens.sees_behind();
}

/// Returns where a camera, moved from `now` to `before`, saw what is infinitely far away at `pixel`.
HD inline Vec2 reproject_far(const CameraView& now, const CameraView& before, Vec2 pixel) {
    if (has_parallel_rays(now.projection)) return pixel;
    const Ray ray = make_camera_ray(now, pixel, {0, 0});
    if (is_outside_lens(ray.origin)) return pixel;
    return project_point(before, before.world_from_camera.translation + ray.direction).pixel;
}

/// Returns how far the direction in which a camera sees `point` turns from `before` to `now`, as the length of the
/// difference of unit directions; negative if it sees all points in one direction.
HD inline float view_turn(const CameraView& now, const CameraView& before, Vec3 point) {
    if (has_parallel_rays(now.projection)) return -1;
    const Vec3 now_seen = normalize(point - now.world_from_camera.translation),
               then_seen = normalize(point - before.world_from_camera.translation);
    return length(now_seen - then_seen);
}

/// Side of a pixel's footprint at `depth`, in metres.
HD inline float pixel_size(const CameraView& camera, float depth) {
    return 2.0f * camera.half_height * camera.inv_height * growth_at(camera, depth);
}

} // namespace pertev
