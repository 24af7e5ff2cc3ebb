#pragma once

// An affine map as a 3x4 matrix by rows: p' = M p + t. Names read `world_from_local`.

#include <optional>

#include "base/host_device.h"
#include "math/bounds3.h"
#include "math/vec3.h"

namespace pertev {

template <class T>
struct TransformOf {
    Vec3Of<T> row0 = {1, 0, 0}, row1 = {0, 1, 0}, row2 = {0, 0, 1}; // rows of the linear part
    Vec3Of<T> translation = {0, 0, 0};
    bool operator==(const TransformOf&) const = default;
};
using Transform = TransformOf<float>;

/// Returns `m` for each lane of T.
template <class T>
HD inline TransformOf<T> for_lanes(const Transform& m) {
    const auto lanes = [](Vec3 v) { return Vec3Of<T>{v.x, v.y, v.z}; };
    return {lanes(m.row0), lanes(m.row1), lanes(m.row2), lanes(m.translation)};
}
template <class T = float>
HD inline Vec3Of<T> transform_vector(const TransformOf<T>& m, Vec3Of<T> v) {
    return {dot(m.row0, v), dot(m.row1, v), dot(m.row2, v)};
}
template <class T = float>
HD inline Vec3Of<T> transform_point(const TransformOf<T>& m, Vec3Of<T> p) {
    return transform_vector(m, p) + m.translation;
}
/// Transpose of the linear part times `n`: with m = local_from_world this transforms a normal from local to world.
template <class T = float>
HD inline Vec3Of<T> transform_transposed(const TransformOf<T>& m, Vec3Of<T> n) {
    return n.x * m.row0 + n.y * m.row1 + n.z * m.row2;
}
/// Absolute values of the linear part times `v`, for error bounds.
template <class T = float>
HD inline Vec3Of<T> transform_sizes(const TransformOf<T>& m, Vec3Of<T> v) {
    return {dot(abs(m.row0), v), dot(abs(m.row1), v), dot(abs(m.row2), v)};
}
/// The map into a world whose origin was moved to `centre`.
HD inline Transform moved_to(Transform m, Vec3 centre) {
    m.translation = m.translation - centre;
    return m;
}
HD inline Vec3 column(const Transform& m, int k) {
    return {component(m.row0, k), component(m.row1, k), component(m.row2, k)};
}
HD inline bool is_finite(const Transform& m) {
    return is_finite(m.row0) && is_finite(m.row1) && is_finite(m.row2) && is_finite(m.translation);
}
HD inline float determinant(const Transform& m) { return dot(m.row0, cross(m.row1, m.row2)); }

/// The map `b` followed by `a`: p' = a(b(p)). Host only: evaluated in double, rounded once.
Transform compose(const Transform& a, const Transform& b);
/// Inverse, evaluated in double. Does not throw: a singular map gives values that are not finite.
Transform inverse(const Transform& m);
/// Returns whether floats cannot hold the inverse of `m`.
bool is_singular(const Transform& m);
/// Product of the largest absolute row sums of the linear part and of its inverse (infinity-norm condition number).
float condition_number(const Transform& m);

/// Removes scale, shear and mirroring from `m`: the same origin, the same -z, upright in the same plane. Nothing if
/// those directions are degenerate.
std::optional<Transform> without_scale(const Transform& m);

Transform make_translation(Vec3 t);
Transform make_scale(Vec3 s);
/// Rotation by a unit quaternion (x, y, z, w).
Transform make_rotation(float x, float y, float z, float w);
/// Column-major 4x4 as glTF stores it; the last row is taken as (0, 0, 0, 1).
Transform transform_from_columns(const float (&m)[16]);
/// World-from-camera transform for an eye that looks along -z with +y up (glTF). `up` is not parallel to target -
/// eye.
Transform look_at(Vec3 eye, Vec3 target, Vec3 up);

} // namespace pertev
