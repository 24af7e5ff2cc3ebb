#include "render/lens_distortion.h"

#include <algorithm>

#include "math/double_vec3.h"
#include "scene/projection_features.h"

namespace pertev {
namespace {

constexpr double kFarthest = 100;       // distance in the view of a polynomial lens: 89.4 degrees from the axis
constexpr double kWidestAngle = 3.1415; // largest angle of a fisheye, radians
constexpr int kSteps = 512, kTurns = 8; // in which the limit is searched for

/// Returns the largest x in [0, most], to 2^-40 of it, up to which `is_good` holds at all steps.
template <class IsGood>
double largest_good(double most, const IsGood& is_good) {
    double low = 0, high = most;
    for (int i = 1; i <= kSteps; ++i) {
        const double s = static_cast<double>(i) / kSteps, x = most * s * s; // finer near the axis
        if (!is_good(x)) {
            high = x;
            break;
        }
        low = x;
    }
    if (low == most) return most;
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (is_good(middle) ? low : high) = middle;
    }
    return low;
}

/// Returns whether the polynomial lens is monotone at distance `r` from the axis, in a unit direction.
bool is_monotone(const LensView& lens, double r, DoubleVec3 direction) {
    const auto number = [](float x) { return static_cast<double>(x); };
    const double k1 = number(lens.k1), k2 = number(lens.k2), k3 = number(lens.k3), k4 = number(lens.k4),
                 k5 = number(lens.k5), k6 = number(lens.k6), p1 = number(lens.p1), p2 = number(lens.p2);
    const double r2 = r * r, below = 1 + r2 * (k4 + r2 * (k5 + r2 * k6));
    if (!(below > 0)) return false;
    const double radial = (1 + r2 * (k1 + r2 * (k2 + r2 * k3))) / below;
    const double slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3) - radial * (k4 + r2 * (2 * k5 + r2 * 3 * k6))) / below;
    const double x = r * direction.x, y = r * direction.y;
    const double xx = radial + x * x * slope + 2 * p1 * y + 6 * p2 * x, xy = x * y * slope + 2 * p1 * x + 2 * p2 * y,
                 yy = radial + y * y * slope + 6 * p1 * y + 2 * p2 * x;
    return xx * yy - xy * xy > 0 && xx + yy > 0;
}

bool is_fisheye_monotone(const LensView& lens, double angle) {
    const auto number = [](float x) { return static_cast<double>(x); };
    const double a2 = angle * angle;
    return 1 + a2 * (3 * number(lens.k1) +
                     a2 * (5 * number(lens.k2) + a2 * (7 * number(lens.k3) + a2 * 9 * number(lens.k4)))) >
           0;
}

} // namespace

bool has_straight_lens(const Camera& camera) {
    const bool is_plain = std::ranges::all_of(camera.distortion, [](double k) { return static_cast<float>(k) == 0; });
    return !has_angle_of_view(camera.projection) || camera.lens == LensModel::Straight ||
           (camera.lens == LensModel::OpenCv && is_plain);
}

LensView make_lens_view(const Camera& camera) {
    if (has_straight_lens(camera)) return {};
    float k[8] = {};
    for (std::size_t i = 0; i < std::min(camera.distortion.size(), std::size(k)); ++i) {
        k[i] = static_cast<float>(camera.distortion[i]);
    }
    LensView lens = {};
    lens.model = camera.lens;
    switch (camera.lens) {
    case LensModel::Straight:
    case LensModel::Equirectangular:
    case LensModel::Cube:
        break;
    case LensModel::OpenCv: // k1, k2, p1, p2, k3, k4, k5, k6
        lens.k1 = k[0], lens.k2 = k[1], lens.k3 = k[4], lens.k4 = k[5], lens.k5 = k[6], lens.k6 = k[7];
        lens.p1 = -k[2], lens.p2 = k[3];
        for (int i = 0; i < (lens.p1 == 0 && lens.p2 == 0 ? 1 : kTurns);
             ++i) { // without p the lens is rotationally symmetric
            float s = 0, c = 0;
            sin_cos_2pi(static_cast<float>(i) / kTurns, s, c);
            const DoubleVec3 direction = to_double(Vec3{c, s, 0});
            const double limit = largest_good(kFarthest, [&](double r) { return is_monotone(lens, r, direction); });
            lens.limit = max(lens.limit, static_cast<float>(limit));
        }
        break;
    case LensModel::Fisheye:
        lens.k1 = k[0], lens.k2 = k[1], lens.k3 = k[2], lens.k4 = k[3];
        lens.limit =
            static_cast<float>(largest_good(kWidestAngle, [&](double a) { return is_fisheye_monotone(lens, a); }));
    }
    return lens;
}

float half_height_through(const LensView& lens, float half_angle) {
    switch (lens.model) {
    case LensModel::Straight:
    case LensModel::OpenCv: // without its coefficients
        return tan(half_angle);
    case LensModel::Equirectangular:
    case LensModel::Cube:
        return panorama_half_size(lens.model).y;
    case LensModel::Fisheye:
        break;
    }
    return fisheye_radius(lens, half_angle).radius;
}

} // namespace pertev
