#include "math/transform.h"

#include <array>

#include "math/double_vec3.h"

namespace pertev {
Transform compose(const Transform& a, const Transform& b) {
    const std::array<DoubleVec3, 3> columns = {to_double(column(b, 0)), to_double(column(b, 1)),
                                               to_double(column(b, 2))};
    const DoubleVec3 moved = to_double(b.translation);
    const auto row = [&](Vec3 r) {
        const DoubleVec3 ar = to_double(r);
        return to_float({dot(ar, columns[0]), dot(ar, columns[1]), dot(ar, columns[2])});
    };
    const DoubleVec3 t = to_double(a.translation);
    return {row(a.row0), row(a.row1), row(a.row2),
            to_float({dot(to_double(a.row0), moved) + t.x, dot(to_double(a.row1), moved) + t.y,
                      dot(to_double(a.row2), moved) + t.z})};
}

Transform inverse(const Transform& m) {
    const DoubleVec3 a = to_double(m.row0), b = to_double(m.row1), c = to_double(m.row2), t = to_double(m.translation);
    const DoubleVec3 bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
    const double inv = 1.0 / dot(a, bc);
    const DoubleVec3 r0 = {bc.x * inv, ca.x * inv, ab.x * inv};
    const DoubleVec3 r1 = {bc.y * inv, ca.y * inv, ab.y * inv};
    const DoubleVec3 r2 = {bc.z * inv, ca.z * inv, ab.z * inv};
    return {to_float(r0), to_float(r1), to_float(r2), to_float({-dot(r0, t), -dot(r1, t), -dot(r2, t)})};
}

bool is_singular(const Transform& m) { return !is_finite(inverse(m)); }

float condition_number(const Transform& m) {
    const auto norm = [](const Transform& a) {
        const auto sum = [](Vec3 r) { return abs(r.x) + abs(r.y) + abs(r.z); };
        return max(sum(a.row0), max(sum(a.row1), sum(a.row2)));
    };
    return norm(m) * norm(inverse(m));
}

std::optional<Transform> without_scale(const Transform& m) {
    const Vec3 back = normalize(column(m, 2));
    const Vec3 right = normalize(cross(column(m, 1), back));
    const Vec3 up = cross(back, right);
    if (!is_finite(back) || !is_finite(right) || !is_finite(m.translation)) return std::nullopt;
    return Transform{{right.x, up.x, back.x}, {right.y, up.y, back.y}, {right.z, up.z, back.z}, m.translation};
}

Transform make_translation(Vec3 t) { return {.translation = t}; }

Transform make_scale(Vec3 s) { return {{s.x, 0, 0}, {0, s.y, 0}, {0, 0, s.z}, {}}; }

Transform make_rotation(float x, float y, float z, float w) {
    return {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
            {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
            {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)},
            {}};
}

Transform transform_from_columns(const float (&m)[16]) {
    return {{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}, {m[12], m[13], m[14]}};
}

Transform look_at(Vec3 eye, Vec3 target, Vec3 up) {
    const Vec3 back = normalize(eye - target);
    const Vec3 right = normalize(cross(up, back));
    const Vec3 above = cross(back, right);
    return {{right.x, above.x, back.x}, {right.y, above.y, back.y}, {right.z, above.z, back.z}, eye};
}

} // namespace pertev
