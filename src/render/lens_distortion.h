#pragma once

// Distorting lenses: OpenCV's polynomial model (calib3d: radial, rational and tangential) and the fisheye of Kannala
// and Brandt ("A Generic Camera Model and Calibration Method for Conventional, Wide-Angle, and Fish-Eye Lenses",
// 2006), as in cv::fisheye. A point of the view, x to the right and y up, is where a pinhole sees a direction at
// distance 1; the lens moves it to its place in the picture.
//
// Both models are polynomials that stop being monotone somewhere, and beyond that show places a second time. A lens
// shows nothing there: `limit` is the largest radius in any direction, or angle, that it shows, and the determinant
// says whether a point of the polynomial model lies before the turn in its own direction.

#include "base/host_device.h"
#include "math/portable_math.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "render/panorama.h"
#include "scene/camera.h"

namespace pertev {

struct LensView {
    LensModel model;
    float k1, k2, k3, k4, k5, k6; // radial
    float p1, p2;                 // tangential; p1 for y up
    float limit;                  // distance from the axis in the view, or for a fisheye radians from it

    HD bool is_straight() const { return model == LensModel::Straight; }
    HD bool sees_behind() const { return pertev::sees_behind(model); }
};

/// Returns whether the camera's pictures have straight lines: polynomial lenses with the coefficients 0 are straight.
bool has_straight_lens(const Camera& camera);
/// Makes the lens of a camera, with its limit.
LensView make_lens_view(const Camera& camera);
/// Returns half the height of a picture that sees `half_angle` up and down, without intrinsics.
float half_height_through(const LensView& lens, float half_angle);

/// A picture position and the derivative of its x and y with respect to the view, a symmetric matrix.
template <class T>
struct DistortedPoint {
    Vec2Of<T> at;
    T xx, xy, yy;
    HD T determinant() const { return xx * yy - xy * xy; }
};

/// Distorts a point of the view by the polynomial model.
template <class T>
HD inline DistortedPoint<T> distort(const LensView& lens, Vec2Of<T> p) {
    const T x = p.x, y = p.y, r2 = x * x + y * y;
    const T above = 1.0f + r2 * (lens.k1 + r2 * (lens.k2 + r2 * lens.k3));
    const T below = 1.0f / (1.0f + r2 * (lens.k4 + r2 * (lens.k5 + r2 * lens.k6)));
    const T slope_above = lens.k1 + r2 * (2.0f * lens.k2 + r2 * (3.0f * lens.k3));
    const T slope_below = lens.k4 + r2 * (2.0f * lens.k5 + r2 * (3.0f * lens.k6));
    const T radial = above * below;
    const T slope = 2.0f * ((slope_above - radial * slope_below) * below); // twice that by r2
    const T px = lens.p1 * x, py = lens.p1 * y, qx = lens.p2 * x, qy = lens.p2 * y;
    return {{x * radial + 2.0f * (px * y) + lens.p2 * (r2 + 2.0f * (x * x)),
             y * radial + lens.p1 * (r2 + 2.0f * (y * y)) + 2.0f * (qx * y)},
            radial + x * x * slope + 2.0f * py + 6.0f * qx,
            x * y * slope + 2.0f * px + 2.0f * qy,
            radial + y * y * slope + 6.0f * py + 2.0f * qx};
}

/// A direction in camera space, of any length, that a lens images at a picture position, if `is_seen`.
template <class T>
struct SeenThroughLens {
    Vec3Of<T> direction;
    MaskOf<T> is_seen;
};

inline constexpr int kLensSteps = 12; // number of steps of Newton's method

/// Inverts distort() at the position `at`, which is also the initial guess; z is -1.
template <class T>
HD inline SeenThroughLens<T> undistort(const LensView& lens, Vec2Of<T> at, float tolerance) {
    Vec2Of<T> p = at;
    const auto keep_in_limit = [&] {
        const T r2 = p.x * p.x + p.y * p.y;
        const T scale = select(r2 > lens.limit * lens.limit, lens.limit / sqrt(r2), T(1.0f));
        p = scale * p;
    };
    keep_in_limit();
    for (int i = 0; i < kLensSteps; ++i) {
        const DistortedPoint<T> there = distort(lens, p);
        const Vec2Of<T> off = at - there.at;
        const T inverse = 1.0f / there.determinant();
        p = p +
            Vec2Of<T>{inverse * (there.yy * off.x - there.xy * off.y), inverse * (there.xx * off.y - there.xy * off.x)};
        keep_in_limit();
    }
    const DistortedPoint<T> there = distort(lens, p);
    const Vec2Of<T> off = at - there.at;
    return {{p.x, p.y, -1.0f}, abs(off.x) <= tolerance && abs(off.y) <= tolerance && there.determinant() > 0.0f};
}

/// The fisheye's distance from the picture's axis at an angle, and its derivative.
template <class T>
struct FisheyeRadius {
    T radius, slope;
};
template <class T>
HD inline FisheyeRadius<T> fisheye_radius(const LensView& lens, T angle) {
    const T a2 = angle * angle;
    return {angle * (1.0f + a2 * (lens.k1 + a2 * (lens.k2 + a2 * (lens.k3 + a2 * lens.k4)))),
            1.0f + a2 * (3.0f * lens.k1 + a2 * (5.0f * lens.k2 + a2 * (7.0f * lens.k3 + a2 * (9.0f * lens.k4))))};
}

/// The unit direction that a fisheye images at the position `at`. The angle is found by Newton's method, or by
/// bisection where that leaves the bracket.
template <class T>
HD inline SeenThroughLens<T> fisheye_direction(const LensView& lens, Vec2Of<T> at, float tolerance) {
    const T radius = sqrt(at.x * at.x + at.y * at.y);
    T low = 0.0f, high = lens.limit, angle = min(radius, high);
    for (int i = 0; i < kLensSteps; ++i) {
        const FisheyeRadius<T> there = fisheye_radius(lens, angle);
        const auto is_below = there.radius < radius;
        low = select(is_below, angle, low);
        high = select(is_below, high, angle);
        const T next = angle - (there.radius - radius) / there.slope;
        angle = select(next >= low - 0x1p-20f && next <= high + 0x1p-20f, next, 0.5f * (low + high));
    }
    angle = clamp(angle, T(0.0f), T(lens.limit));
    T s, c;
    sin_cos_2pi(angle * (0.5f * kInvPi), s, c);
    const T scale = select(radius > 0.0f, s / radius, T(1.0f));
    return {{scale * at.x, scale * at.y, -c}, abs(fisheye_radius(lens, angle).radius - radius) <= tolerance};
}

/// The direction that a distorting lens images at the position `at`, in the unit of the view at distance 1. The lens
/// images nothing where Newton's method ends farther than `tolerance` from it.
template <class T>
HD inline SeenThroughLens<T> seen_through_lens(const LensView& lens, Vec2Of<T> at, float tolerance) {
    switch (lens.model) {
    case LensModel::Equirectangular:
    case LensModel::Cube:
        return {panorama_direction(lens.model, at), MaskOf<T>(at.x == at.x)};
    case LensModel::Fisheye:
        return fisheye_direction(lens, at, tolerance);
    case LensModel::Straight: // all its coefficients are 0
    case LensModel::OpenCv:
        break;
    }
    return undistort(lens, at, tolerance);
}

/// The picture position at which a lens images a point, and the scale of areas there.
struct LensProjection {
    Vec2 at;
    float growth; // area in the picture over that in the view; of a lens that sees behind, over the solid angle
    bool is_seen;
};

HD inline LensProjection project_to_panorama(const LensView& lens, Vec3 point) {
    const PanoramaPosition there = panorama_position(lens.model, point);
    return {there.at, there.growth, is_finite(there.growth)};
}
HD inline LensProjection project_through_fisheye(const LensView& lens, Vec3 point) {
    const float depth = -point.z;
    const float away = sqrt(point.x * point.x + point.y * point.y);
    const float angle = atan2(away, depth);
    const FisheyeRadius<float> there = fisheye_radius(lens, angle);
    const bool is_on_axis = !(away > 0);
    const float scale = is_on_axis ? 1.0f / depth : there.radius / away;
    const float sine = away / sqrt(away * away + depth * depth);
    const float growth = is_on_axis ? 1.0f : there.slope * there.radius / sine;
    return {{scale * point.x, scale * point.y}, growth, angle <= lens.limit && (depth > 0 || away > 0)};
}
HD inline LensProjection project_by_polynomial(const LensView& lens, Vec3 point) {
    const float depth = -point.z;
    const Vec2 p = {point.x / depth, point.y / depth};
    const DistortedPoint<float> there = distort(lens, p);
    const float growth = there.determinant();
    return {there.at, growth, depth > 0 && growth > 0 && p.x * p.x + p.y * p.y <= lens.limit * lens.limit};
}

/// Projects a point of camera space through a distorting lens.
HD inline LensProjection project_through_lens(const LensView& lens, Vec3 point) {
    switch (lens.model) {
    case LensModel::Equirectangular:
    case LensModel::Cube:
        return project_to_panorama(lens, point);
    case LensModel::Fisheye:
        return project_through_fisheye(lens, point);
    case LensModel::Straight: // all its coefficients are 0
    case LensModel::OpenCv:
        break;
    }
    return project_by_polynomial(lens, point);
}

} // namespace pertev
