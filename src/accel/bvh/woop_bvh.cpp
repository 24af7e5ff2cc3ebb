#include "accel/bvh/woop_bvh.h"

#include <cmath>

#include "base/parallel_for.h"
#include "math/scalar.h"

namespace pertev {
namespace {

constexpr uint64_t kGrain = 4096; // triangles

struct WideVec3 {
    double x, y, z;
};
WideVec3 wide(Vec3 v) { return {static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)}; }
WideVec3 operator-(WideVec3 a, WideVec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
double dot(WideVec3 a, WideVec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
WideVec3 cross(WideVec3 a, WideVec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

struct Row {
    Vec3 row;
    float shift;
};

/// direction / size, 0 at `origin`.
Row make_row(WideVec3 direction, double size, WideVec3 origin) {
    const WideVec3 d = {direction.x / size, direction.y / size, direction.z / size};
    return {{static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)},
            static_cast<float>(-dot(d, origin))};
}

bool is_finite(const Row& r) {
    return pertev::is_finite(r.row.x) && pertev::is_finite(r.row.y) && pertev::is_finite(r.row.z) &&
           pertev::is_finite(r.shift);
}

} // namespace

WoopTriangle make_woop_triangle(Vec3 a, Vec3 b, Vec3 c, bool last) {
    const WideVec3 origin = wide(a), ab = wide(b) - origin, ac = wide(c) - origin, n = cross(ab, ac);
    const double n2 = dot(n, n);
    Row height = make_row(n, std::sqrt(n2), origin), u = make_row(cross(ac, n), n2, origin),
        v = make_row(cross(n, ab), n2, origin);
    if (!is_finite(height) || !is_finite(u) || !is_finite(v)) height = u = v = {{0, 0, 0}, 0};
    height.row.x = float_of((bits_of(height.row.x) & ~1u) | (last ? kLastInLeaf : 0u));
    return {height.row, height.shift, u.row, u.shift, v.row, v.shift};
}

WoopBvh make_woop_bvh(const Bvh& bvh) {
    WoopBvh woop = {bvh, std::vector<WoopTriangle>(bvh.triangles.size())};
    parallel_for(bvh.triangles.size(), kGrain, [&](uint64_t i) {
        const BvhTriangle& t = bvh.triangles[i];
        woop.transforms[i] = make_woop_triangle(t.a, t.b, t.c, (t.flags & kLastInLeaf) != 0);
    });
    return woop;
}

WoopBvhView view_of(const WoopBvh& bvh) { return {view_of(static_cast<const Bvh&>(bvh)), bvh.transforms.data()}; }

} // namespace pertev
