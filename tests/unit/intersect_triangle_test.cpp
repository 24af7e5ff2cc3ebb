// The triangle test against exactly known values, and against the same test in higher precision.

#include "trace/intersect/intersect_triangle.h"

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>

#include "tests/support/random.h"
#include "trace/intersect/ray.h"

using namespace pertev;
using namespace pertev::test;

namespace {

bool intersect(Vec3 origin, Vec3 direction, Vec3 a, Vec3 b, Vec3 c, TriangleHit& hit, float t_min = 0,
               float t_max = kInfinity) {
    return intersect_triangle(origin, make_ray_shear(direction), t_min, t_max, a, b, c, hit);
}

/// Moeller-Trumbore in long double: t, and the least of the three weights.
struct Reference {
    long double t, u, v, least;
};
Reference reference(Vec3 o, Vec3 d, Vec3 a, Vec3 b, Vec3 c) {
    using L = long double;
    const auto l = [](float x) { return static_cast<L>(x); };
    const L e1[] = {l(b.x) - l(a.x), l(b.y) - l(a.y), l(b.z) - l(a.z)};
    const L e2[] = {l(c.x) - l(a.x), l(c.y) - l(a.y), l(c.z) - l(a.z)};
    const L s[] = {l(o.x) - l(a.x), l(o.y) - l(a.y), l(o.z) - l(a.z)};
    const L dir[] = {l(d.x), l(d.y), l(d.z)};
    const auto cross = [](const L* p, const L* q, L* r) {
        r[0] = p[1] * q[2] - p[2] * q[1], r[1] = p[2] * q[0] - p[0] * q[2], r[2] = p[0] * q[1] - p[1] * q[0];
    };
    const auto dot = [](const L* p, const L* q) { return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]; };
    L p[3], q[3];
    cross(dir, e2, p);
    cross(s, e1, q);
    const L inv = 1 / dot(e1, p), u = dot(s, p) * inv, v = dot(dir, q) * inv;
    return {dot(e2, q) * inv, u, v, std::min(std::min(u, v), 1 - u - v)};
}

} // namespace

TEST_CASE("a ray through the middle of a triangle gives the distance and the weights") {
    const Vec3 a = {0, 0, 5}, b = {4, 0, 5}, c = {0, 4, 5};
    TriangleHit hit;
    REQUIRE(intersect({1, 2, 1}, {0, 0, 2}, a, b, c, hit));
    CHECK(hit.t == 2.0f); // in multiples of the direction's length
    CHECK(hit.u == 0.25f);
    CHECK(hit.v == 0.5f);
    REQUIRE(intersect({1, 2, 9}, {0, 0, -1}, a, b, c, hit)); // the back face is hit, too
    CHECK(hit.t == 4.0f);
    CHECK(hit.u == 0.25f);
    CHECK(hit.v == 0.5f);
    CHECK_FALSE(intersect({1, 2, 9}, {0, 0, 1}, a, b, c, hit)); // behind the origin
    CHECK_FALSE(intersect({3, 3, 1}, {0, 0, 1}, a, b, c, hit)); // outside the triangle
}

TEST_CASE("both ends of a ray's range are exclusive") {
    const Vec3 a = {0, 0, 4}, b = {4, 0, 4}, c = {0, 4, 4};
    TriangleHit hit;
    CHECK(intersect({1, 1, 0}, {0, 0, 1}, a, b, c, hit, 3.9999998f, 4.0000005f));
    CHECK_FALSE(intersect({1, 1, 0}, {0, 0, 1}, a, b, c, hit, 4, 5));
    CHECK_FALSE(intersect({1, 1, 0}, {0, 0, 1}, a, b, c, hit, 0, 4));
    CHECK_FALSE(intersect({1, 1, 0}, {0, 0, 1}, a, b, c, hit, 5, 4));
}

TEST_CASE("vertices and edges belong to the triangle along all six main directions") {
    for (int axis = 0; axis < 3; ++axis) {
        for (const float sign : {1.0f, -1.0f}) {
            const auto turn = [&](Vec3 p) {
                return axis == 0 ? Vec3{p.z, p.x, p.y} : (axis == 1 ? Vec3{p.y, p.z, p.x} : p);
            };
            const Vec3 a = turn({0, 0, 0}), b = turn({8, 0, 0}), c = turn({0, 8, 0});
            for (const Vec3 p :
                 {Vec3{0, 0, 0}, Vec3{8, 0, 0}, Vec3{0, 8, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}, Vec3{4, 4, 0}}) {
                TriangleHit hit;
                CHECK(intersect(turn(p + Vec3{0, 0, -3 * sign}), turn({0, 0, sign}), a, b, c, hit));
                CHECK(hit.t == 3.0f);
            }
        }
    }
}

TEST_CASE("a triangle without area or with an invalid vertex is never hit") {
    const float nan = std::nanf("");
    TriangleHit hit;
    Random random(4);
    for (int i = 0; i < 10000; ++i) {
        const Vec3 a = random.point(-1, 1), b = random.point(-1, 1), o = random.point(-3, 3);
        const Vec3 towards = 0.5f * (a + b) - o;
        CHECK_FALSE(intersect(o, towards, a, b, a, hit));
        CHECK_FALSE(intersect(o, towards, a, a, a, hit));
        CHECK_FALSE(intersect(o, towards, a, b, {nan, 0, 0}, hit));
        CHECK_FALSE(intersect(o, towards, a, b, {kInfinity, 0, 0}, hit));
        CHECK_FALSE(intersect({nan, 0, 0}, towards, a, b, o, hit));
        CHECK_FALSE(intersect(o, {nan, 1, 0}, a, b, random.point(-1, 1), hit));
        CHECK_FALSE(intersect(o, {0, 0, 0}, a, b, random.point(-1, 1), hit));
    }
}

TEST_CASE("hits agree with extended precision and lie within the boxes' tolerance of the ray") {
    Random random(8);
    uint64_t hits = 0, wrong = 0;
    float worst_units = 0;
    for (int i = 0; i < 200000; ++i) {
        const float far = i % 3 == 0 ? 1.0f : (i % 3 == 1 ? 100.0f : 1e5f);
        const float size = i % 5 == 0 ? 1e-3f : 1.0f;
        const Vec3 at = random.point(-far, far);
        Vec3 a = at + random.point(-size, size), b = at + random.point(-size, size), c = at + random.point(-size, size);
        if (i % 4 == 1) b.x = c.x = a.x; // flat boxes leave no slack
        if (i % 4 == 2) b.z = c.z = a.z;
        const Vec3 o = at + random.point(-5, 5);
        const float wu = random.unit(), wv = random.unit();
        const Vec3 d = a + wu * (b - a) + wv * (c - a) - o;
        const Reference want = reference(o, d, a, b, c);
        TriangleHit hit;
        if (intersect(o, d, a, b, c, hit)) {
            ++hits;
            CHECK(hit.u >= 0);
            CHECK(hit.v >= 0);
            CHECK(hit.u + hit.v <= 1 + 0x1p-22f);
            // Returns the distance of the ray at t from the triangle's box, in units of 2^-24 of |origin| + |bounds|.
            const auto out = [&](float oo, float dd, float x, float y, float z) {
                const double p = static_cast<double>(oo) + static_cast<double>(hit.t) * static_cast<double>(dd);
                const double lo = static_cast<double>(min(min(x, y), z)), hi = static_cast<double>(max(max(x, y), z));
                return static_cast<float>(std::max(lo - p, p - hi));
            };
            const float away =
                max(out(o.x, d.x, a.x, b.x, c.x), max(out(o.y, d.y, a.y, b.y, c.y), out(o.z, d.z, a.z, b.z, c.z)));
            const float scale =
                max_component(abs(o)) + max(max_component(abs(a)), max(max_component(abs(b)), max_component(abs(c))));
            worst_units = max(worst_units, away / (scale * 0x1p-24f));
            wrong += want.least < -1e-2L && size == 1.0f && far < 1e3f ? 1 : 0;
            const Vec3 normal = cross(b - a, c - a); // edge-on, t is ill-conditioned
            if (far == 1.0f && pertev::abs(dot(normal, d)) > 0.05f * length(normal) * length(d)) {
                wrong +=
                    std::fabs(static_cast<long double>(hit.t) - want.t) * static_cast<long double>(length(d)) > 1e-4L
                        ? 1
                        : 0;
            }
        } else {
            wrong += want.least > 1e-2L && far < 1e3f && size == 1.0f ? 1 : 0;
        }
    }
    CHECK(hits > 50000);
    CHECK(wrong == 0);
    MESSAGE("furthest outside its box: ", worst_units, " of 16 units");
    CHECK(worst_units <= 6);
}

TEST_CASE("products that underflow keep their sign") {
    // Edge functions of about 2^-130: a float product would be denormal and lose the sign of the difference.
    const float s = 0x1p-65f;
    TriangleHit hit;
    CHECK(intersect({0, 0, -1}, {0, 0, 1}, {-s, -s, 0}, {s, -s, 0}, {0, s, 0}, hit));
    CHECK(hit.t == 1.0f);
    CHECK_FALSE(intersect({0, -2 * s, -1}, {0, 0, 1}, {-s, -s, 0}, {s, -s, 0}, {0, s, 0}, hit));
    CHECK_FALSE(intersect({s, s, -1}, {0, 0, 1}, {-s, -s, 0}, {s, -s, 0}, {0, s, 0}, hit));
}

TEST_CASE("an edge along the ray or of length zero does not affect the result, at any size") {
    Random random(9);
    uint64_t hits = 0, along = 0, wrong = 0;
    for (int i = 0; i < 200000; ++i) {
        const auto whole = [&] { return static_cast<int>(random.below(7)) - 3; };
        int x[3], y[3];
        for (int k = 0; k < 3; ++k) x[k] = whole(), y[k] = whole();
        if (i % 2 == 0) x[1] = x[0], y[1] = y[0]; // the edge from a to b is along the ray
        const int ox = whole(), oy = whole();
        // The edge functions opposite a, b and c, which are exact for whole numbers.
        const auto edge = [&](int p, int q) { return (x[p] - ox) * (y[q] - oy) - (y[p] - oy) * (x[q] - ox); };
        const int ea = edge(2, 1), eb = edge(0, 2), ec = edge(1, 0);
        const bool is_outside = (ea < 0 || eb < 0 || ec < 0) && (ea > 0 || eb > 0 || ec > 0);
        const bool want = !is_outside && ea + eb + ec != 0;
        const float size = static_cast<float>(std::ldexp(1.0, static_cast<int>(random.below(100)) - 55));
        const auto corner = [&](int k) {
            return size * Vec3{static_cast<float>(x[k]), static_cast<float>(y[k]), static_cast<float>(k)};
        };
        const Vec3 origin = size * Vec3{static_cast<float>(ox), static_cast<float>(oy), -1};
        TriangleHit hit;
        const bool is_hit = intersect(origin, {0, 0, 1}, corner(0), corner(1), corner(2), hit);
        hits += want ? 1 : 0;
        along += ec == 0 && ea == -eb && ea != 0 ? 1 : 0;
        wrong += is_hit != want ? 1 : 0;
    }
    CHECK(hits > 5000);
    CHECK(along > 50000);
    CHECK(wrong == 0);
}
