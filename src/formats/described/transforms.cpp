#include "formats/described/transforms.h"

#include <cmath>

#include "math/double_pi.h"
#include "math/portable_math.h"

namespace pertev::described {
namespace {

DoubleVec3 scaled(double s, DoubleVec3 v) { return {s * v.x, s * v.y, s * v.z}; }
DoubleVec3 unit(DoubleVec3 v) { return v / ::sqrt(dot(v, v)); }
bool is_finite(DoubleVec3 v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Sine and cosine of an angle; exact at multiples of 90 degrees.
void sine_and_cosine(double degrees, double& sine, double& cosine) {
    const double turned = std::fmod(degrees, 360.0);
    const double quarters = std::nearbyint(turned / 90);
    const double rest = (turned - 90 * quarters) * (kPiDouble / 180); // within pi / 4
    // Taylor's series: the first terms left out are below 1e-17.
    double s = 0, c = 0, term = 1;
    for (int n = 0; n < 20; ++n) {
        (n % 2 == 0 ? c : s) += n / 2 % 2 == 0 ? term : -term;
        term *= rest / (n + 1);
    }
    const int turns = (static_cast<int>(quarters) % 4 + 4) % 4;
    sine = turns == 0 ? s : turns == 1 ? c : turns == 2 ? -s : -c;
    cosine = turns == 0 ? c : turns == 1 ? -s : turns == 2 ? -c : s;
}

} // namespace

double determinant(const DoubleTransform& m) { return dot(m.row0, cross(m.row1, m.row2)); }

DoubleTransform inverse(const DoubleTransform& m) {
    const DoubleVec3 x = cross(m.row1, m.row2), y = cross(m.row2, m.row0), z = cross(m.row0, m.row1);
    const double scale = 1 / dot(m.row0, x);
    DoubleTransform to;
    to.row0 = scaled(scale, {x.x, y.x, z.x});
    to.row1 = scaled(scale, {x.y, y.y, z.y});
    to.row2 = scaled(scale, {x.z, y.z, z.z});
    const DoubleVec3 t = m.translation;
    to.translation = scaled(-1, {dot(to.row0, t), dot(to.row1, t), dot(to.row2, t)});
    return to;
}

bool is_finite(const DoubleTransform& m) {
    return is_finite(m.row0) && is_finite(m.row1) && is_finite(m.row2) && is_finite(m.translation);
}

DoubleTransform translation_by(DoubleVec3 t) {
    DoubleTransform m;
    m.translation = t;
    return m;
}

DoubleTransform scale_by(DoubleVec3 s) {
    DoubleTransform m;
    m.row0.x = s.x, m.row1.y = s.y, m.row2.z = s.z;
    return m;
}

DoubleTransform make_rotation(double degrees, DoubleVec3 axis) {
    double s = 0, c = 0;
    sine_and_cosine(degrees, s, c);
    const DoubleVec3 a = unit(axis);
    DoubleTransform m;
    m.row0 = {a.x * a.x + (1 - a.x * a.x) * c, a.x * a.y * (1 - c) - a.z * s, a.x * a.z * (1 - c) + a.y * s};
    m.row1 = {a.x * a.y * (1 - c) + a.z * s, a.y * a.y + (1 - a.y * a.y) * c, a.y * a.z * (1 - c) - a.x * s};
    m.row2 = {a.x * a.z * (1 - c) - a.y * s, a.y * a.z * (1 - c) + a.x * s, a.z * a.z + (1 - a.z * a.z) * c};
    return m;
}

DoubleTransform make_look_at(DoubleVec3 eye, DoubleVec3 target, DoubleVec3 up) {
    const DoubleVec3 forward = unit(target - eye), right = unit(cross(unit(up), forward)),
                     above = cross(forward, right);
    DoubleTransform m; // world from camera has these columns
    m.row0 = right, m.row1 = above, m.row2 = forward;
    m.translation = scaled(-1, {dot(right, eye), dot(above, eye), dot(forward, eye)});
    return m;
}

DoubleTransform transform_of(std::span<const double> numbers) {
    const auto row = [&](std::size_t i) { return DoubleVec3{numbers[i], numbers[4 + i], numbers[8 + i]}; };
    return {row(0), row(1), row(2), {numbers[12], numbers[13], numbers[14]}};
}

} // namespace pertev::described
