#include "math/motion_keys.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "math/double_vec3.h"

namespace pertev {
namespace {

constexpr double kTolerance = 0x1p-11; // in units of a box's size

using Matrix = std::array<DoubleVec3, 3>; // rows

Matrix linear_part(const Transform& m) { return {to_double(m.row0), to_double(m.row1), to_double(m.row2)}; }

DoubleVec3 times(const Matrix& m, DoubleVec3 v) { return {dot(m[0], v), dot(m[1], v), dot(m[2], v)}; }
DoubleVec3 add(DoubleVec3 a, DoubleVec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
DoubleVec3 scaled(double s, DoubleVec3 v) { return {s * v.x, s * v.y, s * v.z}; }
DoubleVec3 transformed(const Transform& m, DoubleVec3 p) {
    return add(times(linear_part(m), p), to_double(m.translation));
}

double determinant(const Matrix& m) { return dot(m[0], cross(m[1], m[2])); }
/// Returns the transpose of the inverse.
Matrix inverse_transposed(const Matrix& m) {
    const double inv = 1 / determinant(m);
    return {scaled(inv, cross(m[1], m[2])), scaled(inv, cross(m[2], m[0])), scaled(inv, cross(m[0], m[1]))};
}
/// Returns a times the inverse of b.
Matrix over(const Matrix& a, const Matrix& b) {
    const Matrix t = inverse_transposed(b); // row i of the product is the sum of a[i].k times column k of b's inverse
    Matrix product;
    for (std::size_t i = 0; i < 3; ++i) product[i] = {dot(a[i], t[0]), dot(a[i], t[1]), dot(a[i], t[2])};
    return product;
}

/// Returns the rotation nearest to `m`; nothing if `m` mirrors or is singular. Source: Higham, "Computing the Polar
/// Decomposition - with Applications", SIAM J. Sci. Stat. Comput. 7(4), 1986.
std::optional<Matrix> nearest_rotation(Matrix m) {
    if (!(determinant(m) > 0)) return std::nullopt;
    for (int step = 0; step < 60; ++step) {
        const Matrix other = inverse_transposed(m);
        double change = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const DoubleVec3 mean = scaled(0.5, add(m[i], other[i]));
            const DoubleVec3 by = mean - m[i];
            change = std::max(change, dot(by, by));
            m[i] = mean;
        }
        if (!(change > 1e-30)) break;
    }
    if (!(std::fabs(determinant(m) - 1) < 1e-9)) return std::nullopt;
    return m;
}

/// Returns the unit quaternion of a rotation, computed from its largest component.
std::array<double, 4> quaternion_of(const Matrix& m) {
    const double x = m[0].x, y = m[1].y, z = m[2].z;
    const double four[4] = {1 + x - y - z, 1 - x + y - z, 1 - x - y + z, 1 + x + y + z}; // squares, four times
    const auto largest = static_cast<std::size_t>(std::max_element(four, four + 4) - four);
    const double twice = std::sqrt(four[largest]), part = 1 / (2 * twice);
    const double from_sums[3] = {m[1].z + m[2].y, m[2].x + m[0].z, m[0].y + m[1].x};        // 4 yz, 4 zx, 4 xy
    const double from_differences[3] = {m[2].y - m[1].z, m[0].z - m[2].x, m[1].x - m[0].y}; // 4 xw, 4 yw, 4 zw
    std::array<double, 4> q{};
    q[largest] = twice / 2;
    if (largest == 3) {
        for (std::size_t k = 0; k < 3; ++k) q[k] = from_differences[k] * part;
        return q;
    }
    for (std::size_t k = 0; k < 3; ++k) {
        if (k != largest) q[k] = from_sums[3 - k - largest] * part;
    }
    q[3] = from_differences[largest] * part;
    return q;
}

double dot(const std::array<double, 4>& a, const Vec4& b) {
    return a[0] * static_cast<double>(b.x) + a[1] * static_cast<double>(b.y) + a[2] * static_cast<double>(b.z) +
           a[3] * static_cast<double>(b.w);
}

RigidMotion at_key(const MotionKey& key, Vec3 pivot) { return rigid_motion(key.turn, pivot, key.position); }

/// Motion of one object through its positions at the times 0, 1 / segments, ..., 1.
Motion motion_through(const PlacedBox& thing, std::span<const std::optional<Transform>> transforms_then) {
    const Vec3 middle = thing.box.centre();
    Motion motion;
    motion.pivot = to_float(transformed(thing.world_from_local, to_double(middle)));
    MotionKey key = {{0, 0, 0, 1}, motion.pivot};
    bool moves = false;
    for (const std::optional<Transform>& now : transforms_then) {
        if (now) {
            const auto turn = nearest_rotation(over(linear_part(*now), linear_part(thing.world_from_local)));
            if (turn) {
                std::array<double, 4> q = quaternion_of(*turn);
                const double sign = dot(q, key.turn) < 0 ? -1 : 1; // the nearer of the two quaternions
                key.turn = {static_cast<float>(sign * q[0]), static_cast<float>(sign * q[1]),
                            static_cast<float>(sign * q[2]), static_cast<float>(sign * q[3])};
            }
            key.position = to_float(transformed(*now, to_double(middle)));
            moves = moves || !(*now == thing.world_from_local);
        }
        motion.keys.push_back(key);
    }
    if (!moves) motion.keys.clear();
    return motion;
}

/// Returns whether the fitted motion takes all corners of the box to their positions at `time`, apart from what no
/// rigid motion can do.
bool is_near(const PlacedBox& thing, const Motion& fitted, uint32_t segments, double time, const Transform& wanted) {
    if (fitted.keys.empty()) return wanted == thing.world_from_local;
    const RigidMotion now = motion_at(fitted.keys.data(), segments, fitted.pivot, static_cast<float>(time));
    const std::optional<Transform> one[] = {wanted};
    const Motion exact = motion_through(thing, one); // the nearest rigid one
    const RigidMotion target = exact.keys.empty() ? RigidMotion{} : at_key(exact.keys[0], exact.pivot);
    double size = 0, off = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Bounds3& b = thing.box;
        const Vec3 local = {corner & 1 ? b.hi.x : b.lo.x, corner & 2 ? b.hi.y : b.lo.y, corner & 4 ? b.hi.z : b.lo.z};
        const Vec3 at = to_float(transformed(thing.world_from_local, to_double(local)));
        const DoubleVec3 from_pivot = to_double(at) - to_double(fitted.pivot);
        const DoubleVec3 by = to_double(now.move(at)) - to_double(target.move(at));
        size = std::max(size, dot(from_pivot, from_pivot));
        off = std::max(off, dot(by, by));
    }
    const double rounding = 0x1p-21 * static_cast<double>(max_component(abs(now.position)));
    return std::sqrt(off) <= kTolerance * std::sqrt(size) + rounding;
}

} // namespace

FittedMotions fit_motions(std::span<const PlacedBox> things, const TransformsAt& transforms_at,
                          std::span<const double> check_times) {
    std::map<double, std::vector<std::optional<Transform>>> known; // by time: keys of few segments are keys of many
    const auto transforms_then = [&](double time) -> const std::vector<std::optional<Transform>>& {
        const auto [at, is_new] = known.try_emplace(time);
        if (is_new) at->second = transforms_at(time);
        return at->second;
    };
    FittedMotions fitted;
    const auto is_good_at = [&](double time) {
        const auto& now = transforms_then(time);
        for (std::size_t i = 0; i < things.size(); ++i) {
            if (now[i] && !is_near(things[i], fitted.motions[i], fitted.segments, time, *now[i])) return false;
        }
        return true;
    };
    for (fitted.segments = kFewestMotionSegments;; fitted.segments *= 2) {
        const uint32_t segments = fitted.segments;
        std::vector<std::vector<std::optional<Transform>>> of_thing(things.size());
        for (uint32_t k = 0; k <= segments; ++k) {
            const auto& now = transforms_then(static_cast<double>(k) / segments);
            for (std::size_t i = 0; i < things.size(); ++i) of_thing[i].push_back(now[i]);
        }
        fitted.motions.clear();
        for (std::size_t i = 0; i < things.size(); ++i) {
            fitted.motions.push_back(motion_through(things[i], of_thing[i]));
        }
        if (segments == kMaxMotionSegments) return fitted;
        bool is_good = std::ranges::all_of(check_times, is_good_at);
        for (uint32_t k = 0; k < segments && is_good; ++k) {
            // No even parts of a segment: what comes back in such parts would be visible only at its ends.
            for (const double part : {0.21, 0.5, 0.83}) is_good = is_good && is_good_at((k + part) / segments);
        }
        if (is_good) return fitted;
    }
}

Bounds3 swept_bounds(const MotionKeys& motions, uint32_t motion, const Bounds3& box) {
    const MotionKey* const keys = motions.keys.data() + std::size_t(motion) * (motions.segments + 1);
    const Vec3 pivot = motions.pivots[motion];
    const DoubleVec3 lo = to_double(box.lo), hi = to_double(box.hi);
    const DoubleVec3 half = scaled(0.5, hi - lo), from_pivot = scaled(0.5, add(lo, hi)) - to_double(pivot);
    const double radius = std::sqrt(dot(half, half)) + std::sqrt(dot(from_pivot, from_pivot));
    // Between two keys a point leaves the straight line by less than this: at most radius (1 - cos(turn / 2)), and as
    // much again for where on the line it is by then.
    double bulge = 0;
    DoubleVec3 least = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, most = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (uint32_t k = 0; k <= motions.segments; ++k) {
        const RigidMotion at = at_key(keys[k], pivot);
        const Matrix turn = {to_double(at.row0), to_double(at.row1), to_double(at.row2)};
        const DoubleVec3 centre = add(times(turn, from_pivot), to_double(at.position));
        const auto reach = [&](DoubleVec3 row) {
            return std::fabs(row.x) * half.x + std::fabs(row.y) * half.y + std::fabs(row.z) * half.z;
        };
        const DoubleVec3 size = {reach(turn[0]), reach(turn[1]), reach(turn[2])};
        least = {std::min(least.x, centre.x - size.x), std::min(least.y, centre.y - size.y),
                 std::min(least.z, centre.z - size.z)};
        most = {std::max(most.x, centre.x + size.x), std::max(most.y, centre.y + size.y),
                std::max(most.z, centre.z + size.z)};
        if (k == 0) continue;
        const Vec4 &a = keys[k - 1].turn, b = keys[k].turn;
        const double c = dot(std::array<double, 4>{static_cast<double>(a.x), static_cast<double>(a.y),
                                                   static_cast<double>(a.z), static_cast<double>(a.w)},
                             b);
        bulge = std::max(bulge, 2 * radius * std::clamp(1 - c * c, 0.0, 1.0));
    }
    const double margin = bulge + 1e-6 * (radius + static_cast<double>(max_component(abs(pivot))));
    const auto down = [&](double x) { return std::nextafterf(static_cast<float>(x - margin), -kInfinity) + 0.0f; };
    const auto up = [&](double x) { return std::nextafterf(static_cast<float>(x + margin), kInfinity) + 0.0f; };
    return {{down(least.x), down(least.y), down(least.z)}, {up(most.x), up(most.y), up(most.z)}};
}

} // namespace pertev
