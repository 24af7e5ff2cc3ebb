#pragma once

// Angles in degrees for people, and the size of a camera's view, also as settings state it. Not every angle in radians
// has degrees that convert back to the same bits, so they are searched for. Above render/ only this file distinguishes
// kinds of cameras.

#include <bit>
#include <cstdint>
#include <initializer_list>

#include "math/scalar.h"
#include "render/camera_view.h"
#include "settings/camera_choice.h"

namespace pertev {

inline constexpr float kRadiansPerDegree = kPi / 180.0f;

/// Returns degrees in (0, 360) that choose_camera() converts to `radians`, to the bit if such degrees exist.
inline float degrees_for(float radians) {
    const float near = radians * (180 / kPi);
    const auto bits = std::bit_cast<uint32_t>(near); // adding or subtracting one gives the adjacent floats
    for (uint32_t i = 0; i < 16; ++i) {
        for (const uint32_t candidate : {bits - i, bits + i}) {
            const auto degrees = std::bit_cast<float>(candidate);
            if (degrees * kRadiansPerDegree == radians) return degrees;
        }
    }
    return near;
}

/// The vertical angle of a camera's view, radians; 0 if its rays are parallel, so that the view has only a height.
inline float view_angle(const Camera& camera) { return has_parallel_rays(camera.projection) ? 0 : camera.fov_y; }
/// The height of the view at a distance, metres.
inline float view_height_at(const Camera& camera, float distance) {
    return 2 * half_view_height(camera) * (view_angle(camera) > 0 ? distance : 1.0f);
}

/// Puts the lens of `camera` into a choice: its projection, the size of its view, its aperture and focus.
inline void state_lens(const Camera& camera, CameraChoice& choice) {
    choice.projection = camera.projection;
    if (const auto& own = camera.intrinsics) {
        choice.intrinsics = {own->focal_x, own->focal_y, own->centre_x, own->centre_y};
        choice.intrinsics_size = PictureSize{own->width, own->height};
    } else if (view_angle(camera) > 0) {
        choice.fov_deg = degrees_for(camera.fov_y);
    } else {
        choice.view_height = camera.ortho_height;
    }
    choice.aperture = camera.aperture_radius;
    if (camera.aperture_radius > 0) {
        const ApertureShape& shape = camera.aperture;
        choice.focus = camera.focus_distance;
        if (shape.blades > 0) choice.aperture_blades = shape.blades, choice.aperture_rotation = shape.rotation_deg;
        if (shape.ratio != 1) choice.aperture_ratio = shape.ratio;
    }
    if (camera.lens != LensModel::Straight) choice.lens = camera.lens;
    choice.distortion = camera.distortion;
}

} // namespace pertev
