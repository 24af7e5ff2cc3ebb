#pragma once

// The camera's rays of a picture: where in a pixel and on the lens a sample lies is drawn from the pixel filter and the
// lens; every integrator begins with them.

#include <cstdint>

#include "math/sampler.h"
#include "render/camera_view.h"
#include "render/pixel_filter.h"

namespace pertev {

/// The first groups of a sample's random numbers (math/sampler.h): place in the pixel; place on the lens, and the time.
enum CameraGroup : uint32_t { kGroupCamera, kGroupLens, kCameraGroups };
inline constexpr uint32_t kNumberTime = 2; // of the lens's group

struct CameraRays {
    CameraView view;
    PixelFilterView filter;
    Vec3 axis;              // unit, world space: depth is measured along it
    uint32_t width, height; // pixels
    bool is_open = false;   // a shutter, through which something is seen to move
    MotionTrack motion;     // of the camera

    /// The ray of the sample that lies at `in_filter` and `on_lens`, unit squares. Unit direction.
    HD Ray ray(uint32_t pixel, Vec2 in_filter, Vec2 on_lens) const {
        const Vec2 offset = sample_filter(filter, in_filter);
        const uint32_t row = pixel / width;
        const Vec2 place = {static_cast<float>(pixel % width) + 0.5f + offset.x,
                            static_cast<float>(row) + 0.5f + offset.y};
        return make_camera_ray(view, place, on_lens);
    }
    /// The same at `time` (below).
    HD Ray ray(uint32_t pixel, Vec2 in_filter, Vec2 on_lens, float time) const {
        const Ray still = ray(pixel, in_filter, on_lens);
        return motion.moves() ? moved(still, time) : still;
    }
    /// The ray of a sample of `pixel`, by the numbers that `key` draws.
    HD Ray ray(uint32_t pixel, SamplerKind sampler, SampleKey key) const {
        const Vec2 in_filter = sample_2d(sampler, key, kGroupCamera);
        const Vec2 on_lens = has_lens() ? sample_2d(sampler, key, kGroupLens) : Vec2{};
        return ray(pixel, in_filter, on_lens, motion.moves() ? time(sampler, key) : kAtRest);
    }
    /// Of the sample that `key` draws, evenly over the time that the shutter is open, [0, 1).
    HD float time(SamplerKind sampler, SampleKey key) const {
        return is_open ? sample_1d(sampler, key, kGroupLens, kNumberTime) : kAtRest;
    }
    /// `axis` at the time of a ray.
    HD Vec3 axis_at(float time) const { return motion.moves() ? motion.at(time).turn(axis) : axis; }
    /// Density of a ray's direction where it counts as one that a white surface scatters, which a light meter does,
    /// 1/sr; else 0.
    HD float pdf_of_surface(Vec3 direction) const {
        return is_light_meter(view.projection) ? pdf_cosine_hemisphere(dot(direction, axis)) : 0.0f;
    }
    HD bool has_lens() const { return view.aperture_radius > 0; }

private:
    HD Ray moved(const Ray& still, float time) const {
        const RigidMotion now = motion.at(time);
        return {now.move(still.origin), still.t_min, normalize(now.turn(still.direction)), still.t_max};
    }
};

/// `centre`: the origin of the scene's world, in the camera's coordinates. The shutter is left closed.
inline CameraRays make_camera_rays(const Camera& camera, const PixelFilterView& filter, uint32_t width, uint32_t height,
                                   Vec3 centre) {
    const Vec3 axis = normalize(transform_vector(camera.world_from_camera, {0, 0, -1}));
    return {make_camera_view(camera, width, height, centre), filter, axis, width, height, false, {}};
}

} // namespace pertev
