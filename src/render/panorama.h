#pragma once

// Panoramas as lenses: the picture position of each direction of camera space, and the reverse. The view is x to the
// right and y up.
//   Equirectangular  x is the longitude in [-pi, pi], from -z to the right, y the latitude in [-pi/2, pi/2]
//   Cube             a strip of six faces of side 2, x in [-6, 6]: front (-z), right (x), back, left, up, down. Each
//                    shows what a camera in that direction sees with an angle of view of 90 degrees; the lower edge of
//                    "up" and the upper edge of "down" meet the front.

#include "base/host_device.h"
#include "math/portable_math.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "scene/lens_model.h"

namespace pertev {

/// Returns whether a panorama is the strip of a cube's faces.
HD inline bool is_cube(LensModel panorama) {
    switch (panorama) {
    case LensModel::Cube:
        return true;
    case LensModel::Straight: // this and the next two are no panoramas
    case LensModel::OpenCv:
    case LensModel::Fisheye:
    case LensModel::Equirectangular:
        break;
    }
    return false;
}

/// Half of a panorama's width and height in the view.
HD inline Vec2 panorama_half_size(LensModel lens) { return is_cube(lens) ? Vec2{6, 1} : Vec2{kPi, 0.5f * kPi}; }

template <class T>
HD inline Vec3Of<T> equirectangular_direction(Vec2Of<T> at) {
    T sine, cosine, height, radius;
    sin_cos_2pi(at.x * (0.5f * kInvPi), sine, cosine);
    sin_cos_2pi(at.y * (0.5f * kInvPi), height, radius);
    return {sine * radius, height, -(cosine * radius)};
}
template <class T>
HD inline Vec3Of<T> cube_direction(Vec2Of<T> at) {
    T face = 0.0f;
    for (int k = 1; k < 6; ++k) face = select(at.x >= static_cast<float>(2 * k - 6), T(static_cast<float>(k)), face);
    const T u = at.x + 5.0f - 2.0f * face, v = at.y, one = 1.0f;
    const auto of = [&](T front, T right, T back, T left, T up, T down) {
        const T sides = select(face < 1.0f, front, select(face < 2.0f, right, select(face < 3.0f, back, left)));
        return select(face < 4.0f, sides, select(face < 5.0f, up, down));
    };
    return {of(u, one, -u, -one, u, u), of(v, v, v, v, one, -one), of(-one, u, one, -u, v, -v)};
}

/// The direction of camera space, of any length, at a position of the view. Longitudes and latitudes beyond the borders
/// go on around the sphere.
template <class T>
HD inline Vec3Of<T> panorama_direction(LensModel lens, Vec2Of<T> at) {
    return is_cube(lens) ? cube_direction(at) : equirectangular_direction(at);
}

/// The position of a direction in the view, and the area there over the solid angle.
struct PanoramaPosition {
    Vec2 at;
    float growth;
};
HD inline PanoramaPosition equirectangular_position(Vec3 d) {
    const float radius = sqrt(d.x * d.x + d.z * d.z);
    return {{atan2(d.x, -d.z), atan2(d.y, radius)}, sqrt(radius * radius + d.y * d.y) / radius};
}
HD inline PanoramaPosition cube_position(Vec3 d) {
    const float x = abs(d.x), y = abs(d.y), z = abs(d.z), most = max(x, max(y, z));
    const Vec3 on_cube = (1.0f / most) * d;
    const float growth = length_squared(on_cube) * length(on_cube);
    int face;
    Vec2 on_face;
    if (y > x && y > z) {
        face = d.y > 0 ? 4 : 5;
        on_face = {on_cube.x, d.y > 0 ? on_cube.z : -on_cube.z};
    } else if (x > z) {
        face = d.x > 0 ? 1 : 3;
        on_face = {d.x > 0 ? on_cube.z : -on_cube.z, on_cube.y};
    } else {
        face = d.z > 0 ? 2 : 0;
        on_face = {d.z > 0 ? -on_cube.x : on_cube.x, on_cube.y};
    }
    return {{on_face.x + static_cast<float>(2 * face - 5), on_face.y}, growth};
}
HD inline PanoramaPosition panorama_position(LensModel lens, Vec3 d) {
    return is_cube(lens) ? cube_position(d) : equirectangular_position(d);
}

} // namespace pertev
