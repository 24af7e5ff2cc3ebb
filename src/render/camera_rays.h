#pragma once

// Camera rays of a picture. The pixel filter and the lens determine where a sample lies in the pixel and on the lens.
// Every integrator starts with these rays.

#include <cstdint>

#include "device_scene/interior_list.h"
#include "math/sampler.h"
#include "render/camera_view.h"
#include "render/pixel_filter.h"

namespace pertev {

/// The first groups of a sample's random numbers (math/sampler.h): position in the pixel; position on the lens, and
/// time.
enum CameraGroup : uint32_t { kGroupCamera, kGroupLens, kCameraGroups };
inline constexpr uint32_t kNumberTime = 2; // in the lens's group

struct CameraRays {
    CameraView view;
    PixelFilterView filter;
    Vec3 axis;              // unit, world space; depth is measured along it
    uint32_t width, height; // pixels
    bool is_open = false;   // whether the shutter is open and something moves
    MotionTrack motion;     // motion of the camera
    InteriorList interior;  // nested solids that hold the camera at rest

    /// Upper left corner of a pixel, in pixels.
    HD Vec2 corner_of(uint32_t pixel) const {
        const uint32_t row = pixel / width;
        return {static_cast<float>(pixel % width), static_cast<float>(row)};
    }
    /// Ray of the sample at `in_filter` and `on_lens`, in unit squares, before the camera's motion.
    template <class T>
    HD RayLineOf<T> line(Vec2Of<T> corner, Vec2Of<T> in_filter, Vec2Of<T> on_lens) const {
        const Vec2Of<T> offset = sample_filter(filter, in_filter);
        return make_camera_line(view, Vec2Of<T>{corner.x + 0.5f + offset.x, corner.y + 0.5f + offset.y}, on_lens);
    }
    /// The ray of `line` at `time`, as time() draws it. Its direction is unit.
    HD Ray ray(const RayLine& line, float time) const {
        const Ray still = {line.origin, 0.0f, line.direction, kInfinity};
        return motion.moves() ? moved(still, time) : still;
    }
    /// Ray of a sample of `pixel` with the random numbers of `key`.
    HD Ray ray(uint32_t pixel, SamplerKind sampler, SampleKey key) const {
        const Vec2 in_filter = sample_2d(sampler, key, kGroupCamera);
        const Vec2 on_lens = has_lens() ? sample_2d(sampler, key, kGroupLens) : Vec2{};
        return ray(line(corner_of(pixel), in_filter, on_lens), motion.moves() ? time(sampler, key) : kAtRest);
    }
    /// The ray from the lens, where `ray` starts, to `point`; parallel rays keep their direction.
    HD Ray ray_to(const Ray& ray, Vec3 point) const {
        const Vec3 to = point - ray.origin;
        if (!has_parallel_rays(view.projection)) return {ray.origin, ray.t_min, normalize(to), ray.t_max};
        return {point - dot(to, ray.direction) * ray.direction, ray.t_min, ray.direction, ray.t_max};
    }
    /// Ray through the centre of `pixel`, without the lens.
    HD Ray centre_ray(uint32_t pixel, float time) const {
        const Vec2 corner = corner_of(pixel);
        CameraView pinhole = view;
        pinhole.aperture_radius = 0;
        return ray(make_camera_line(pinhole, Vec2{corner.x + 0.5f, corner.y + 0.5f}, Vec2{0, 0}), time);
    }
    /// Width of a pixel at a distance along its ray, metres, as in the middle of the picture.
    HD float pixel_width(float distance) const { return pixel_size(view, distance); }
    /// Time of the sample with the random numbers of `key`, uniform over the open shutter, in [0, 1).
    HD float time(SamplerKind sampler, SampleKey key) const {
        return is_open ? sample_1d(sampler, key, kGroupLens, kNumberTime) : kAtRest;
    }
    /// The axis at a ray's time.
    HD Vec3 axis_at(float time) const { return motion.moves() ? motion.at(time).rotate(axis) : axis; }
    /// Density of the direction in 1/sr for a light meter, whose rays count as scattered by a white surface; otherwise
    /// 0.
    HD float pdf_of_surface(Vec3 direction) const {
        return is_meter() ? pdf_cosine_hemisphere(dot(direction, axis)) : 0.0f;
    }
    HD bool is_meter() const { return is_light_meter(view.projection); }
    HD bool has_lens() const { return view.aperture_radius > 0; }

private:
    HD Ray moved(const Ray& still, float time) const {
        const RigidMotion now = motion.at(time);
        return {now.move(still.origin), still.t_min, normalize(now.rotate(still.direction)), still.t_max};
    }
};

/// Makes the rays of a camera with a closed shutter. `centre` is the origin of the scene's world in the camera's
/// coordinates.
inline CameraRays make_camera_rays(const Camera& camera, const PixelFilterView& filter, uint32_t width, uint32_t height,
                                   Vec3 centre) {
    const Vec3 axis = normalize(transform_vector(camera.world_from_camera, {0, 0, -1}));
    return {make_camera_view(camera, width, height, centre), filter, axis, width, height, false, {}, {}};
}

} // namespace pertev
