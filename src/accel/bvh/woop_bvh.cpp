#include "accel/bvh/woop_bvh.h"

#include <cmath>

#include "base/parallel_until.h"
#include "math/double_vec3.h"
#include "math/scalar.h"

namespace pertev {
namespace {

constexpr uint64_t kWoopGrain = 4096; // triangles

struct WoopRow {
    Vec3 row;
    float shift;
};

/// Returns the row direction / size that is 0 at `origin`.
WoopRow make_row(DoubleVec3 direction, double size, DoubleVec3 origin) {
    const DoubleVec3 d = direction / size;
    return {to_float(d), static_cast<float>(-dot(d, origin))};
}

bool is_finite(const WoopRow& r) {
    return pertev::is_finite(r.row.x) && pertev::is_finite(r.row.y) && pertev::is_finite(r.row.z) &&
           pertev::is_finite(r.shift);
}

} // namespace

WoopTriangle make_woop_triangle(Vec3 a, Vec3 b, Vec3 c, bool last) {
    const DoubleVec3 origin = to_double(a), ab = to_double(b) - origin, ac = to_double(c) - origin, n = cross(ab, ac);
    const double n2 = dot(n, n);
    WoopRow height = make_row(n, std::sqrt(n2), origin), u = make_row(cross(ac, n), n2, origin),
            v = make_row(cross(n, ab), n2, origin);
    if (!is_finite(height) || !is_finite(u) || !is_finite(v)) {
        height = v = {{0, 0, 0}, 0};
        u = {{0, 0, 0}, -1}; // outside, whatever t the height gives; the height still holds a flag
    }
    height.row.x = float_of((bits_of(height.row.x) & ~1u) | (last ? kLastInLeaf : 0u));
    return {height.row, height.shift, u.row, u.shift, v.row, v.shift};
}

WoopBvh make_woop_bvh(const Bvh& bvh, Sink& sink) {
    WoopBvh woop = {bvh, std::vector<WoopTriangle>(bvh.triangles.size())};
    parallel_until(bvh.triangles.size(), kWoopGrain, sink, [&](uint64_t i) {
        const BvhTriangle& t = bvh.triangles[i];
        woop.transforms[i] = make_woop_triangle(t.a, t.b, t.c, (t.flags & kLastInLeaf) != 0);
    });
    return woop;
}

WoopBvhView view_of(const WoopBvh& bvh) { return {view_of(static_cast<const Bvh&>(bvh)), bvh.transforms.data()}; }

} // namespace pertev
