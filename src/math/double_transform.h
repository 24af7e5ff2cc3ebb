#pragma once

// An affine map in double, for chains of nodes, whose transforms may lead far from the origin and back. Host only.

#include "math/double_vec3.h"
#include "math/transform.h"

namespace pertev {

struct DoubleTransform {
    DoubleVec3 row0 = {1, 0, 0}, row1 = {0, 1, 0}, row2 = {0, 0, 1}; // rows of the linear part
    DoubleVec3 translation = {0, 0, 0};
    bool operator==(const DoubleTransform&) const = default;
};

inline DoubleVec3 transform_point(const DoubleTransform& m, DoubleVec3 p) {
    return DoubleVec3{dot(m.row0, p), dot(m.row1, p), dot(m.row2, p)} + m.translation;
}

/// The map `b` followed by `a`: p' = a(b(p)).
inline DoubleTransform compose(const DoubleTransform& a, const DoubleTransform& b) {
    const auto row = [&](DoubleVec3 r) {
        return DoubleVec3{dot(r, {b.row0.x, b.row1.x, b.row2.x}), dot(r, {b.row0.y, b.row1.y, b.row2.y}),
                          dot(r, {b.row0.z, b.row1.z, b.row2.z})};
    };
    return {row(a.row0), row(a.row1), row(a.row2), transform_point(a, b.translation)};
}

inline DoubleTransform to_double(const Transform& m) {
    return {to_double(m.row0), to_double(m.row1), to_double(m.row2), to_double(m.translation)};
}
/// Rounds each number.
inline Transform to_float(const DoubleTransform& m) {
    return {to_float(m.row0), to_float(m.row1), to_float(m.row2), to_float(m.translation)};
}

} // namespace pertev
