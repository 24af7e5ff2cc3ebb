#include <algorithm>
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "device_scene/ray_origin.h"
#include "tests/support/meshes.h"

using namespace pertev;

namespace {

using Limits = std::numeric_limits<float>;

/// Returns the signed distance of `p` from the plane through `on`. Products of two floats are exact in double
/// precision.
double side(Vec3 p, Vec3 on, Vec3 normal) {
    const auto term = [](float a, float b, float n) {
        return (static_cast<double>(a) - static_cast<double>(b)) * static_cast<double>(n);
    };
    return term(p.x, on.x, normal.x) + term(p.y, on.y, normal.y) + term(p.z, on.z, normal.z);
}

} // namespace

TEST_CASE("next_float is the neighbour in the direction of the sign") {
    test::Random random(2);
    for (int i = 0; i < 100'000; ++i) {
        const float x = std::ldexp(random.within(-1, 1), static_cast<int>(random.below(200)) - 100);
        if (x == 0) continue;
        CHECK(next_float(x, 1.0f) == std::nextafter(x, Limits::infinity()));
        CHECK(next_float(x, -1.0f) == std::nextafter(x, -Limits::infinity()));
    }
    for (const float x : {1.0f, -1.0f, 0x1p-126f, -0x1p-126f, Limits::denorm_min(), -Limits::denorm_min(), 0x1p40f}) {
        CAPTURE(x);
        CHECK(next_float(x, 0.1f) == std::nextafter(x, Limits::infinity()));
        CHECK(next_float(x, -1e-30f) == std::nextafter(x, -Limits::infinity()));
    }
    for (const float zero : {0.0f, -0.0f}) {
        CHECK(next_float(zero, 3.0f) == Limits::denorm_min());
        CHECK(next_float(zero, -3.0f) == -Limits::denorm_min());
    }
}

TEST_CASE("an offset origin is never on the wrong side, wherever the true point lies within its error") {
    test::Random random(7);
    double least = 1e30, farthest = 0;
    for (int i = 0; i < 200'000; ++i) {
        const float size = std::ldexp(1.0f, static_cast<int>(random.below(36)) - 8); // to about 150 000 km
        const Vec3 point = random.point(-size, size);
        const Vec3 normal = i % 10 == 0 ? Vec3{0, i % 20 == 0 ? 1.0f : -1.0f, 0} : random.direction();
        const Vec3 direction = random.direction();
        const float scale = i % 3 == 0 ? 0x1p-23f : 0x1p-20f;
        const Vec3 error = scale * abs(point);
        // The plane can pass through any corner of the error box.
        const auto sign = [&] { return random.unit() < 0.5f ? -1.0f : 1.0f; };
        const float sx = sign(), sy = sign(), sz = sign();
        const Vec3 on_plane = {point.x + sx * error.x, point.y + sy * error.y, point.z + sz * error.z};
        const Vec3 moved = offset_ray_origin(point, error, normal, direction);
        const double wanted = dot(direction, normal) < 0 ? -1 : 1;
        // The corner itself is rounded by half a unit in each component, times the normal.
        double slack = 0;
        for (int k = 0; k < 3; ++k) {
            slack +=
                0x1p-24 * static_cast<double>(pertev::abs(component(on_plane, k)) * pertev::abs(component(normal, k)));
        }
        const double away = wanted * side(moved, on_plane, normal);
        least = std::min(least, away + slack);
        // The offset is at most twice the error plus one float step per component and the rounding.
        const double bound = static_cast<double>(dot(abs(normal), error));
        farthest = std::max(farthest, (away - slack) / (2 * bound + 4 * 0x1p-23 * static_cast<double>(size)));
    }
    CHECK(least >= 0);
    CHECK(farthest <= 1);
    CHECK(farthest > 0.2); // the bound is not trivial
}

TEST_CASE("an exact point on an axis-aligned plane is still offset, and only along the normal") {
    const Vec3 up = offset_ray_origin({5, 2, -3}, {0, 1e-6f, 0}, {0, 1, 0}, {0.6f, 0.8f, 0});
    CHECK(up.x == 5);
    CHECK(up.y > 2);
    CHECK(up.z == -3);
    CHECK(offset_ray_origin({5, 2, -3}, {0, 1e-6f, 0}, {0, 1, 0}, {0.6f, -0.8f, 0}).y < 2);
    CHECK(offset_ray_origin({5, 2, -3}, {0, 1e-6f, 0}, {0, -1, 0}, {0.6f, 0.8f, 0}).y > 2); // the ray leaves the back
    // Even for an error far below a unit in the last place the origin moves to the next float.
    CHECK(offset_ray_origin({0, 1024, 0}, {0, 1e-12f, 0}, {0, 1, 0}, {0, 1, 0}).y == std::nextafter(1024.0f, 2e3f));
    CHECK(offset_ray_origin({1, 2, 3}, {0, 0, 0}, {0, 1, 0}, {0, 1, 0}) == Vec3{1, 2, 3}); // the point is known exactly
}

TEST_CASE("a point near an edge is moved inwards, and any other is kept to the bit") {
    test::Random random(11);
    for (int i = 0; i < 100'000; ++i) {
        const float least = i % 50 == 0 ? 0.25f : std::ldexp(random.unit(), -2 - static_cast<int>(random.below(22)));
        float u = random.unit(), v = random.unit();
        if (u + v > 1) u = 1 - u, v = 1 - v;
        if (i % 3 == 0) u = i % 2 == 0 ? 0.0f : least * random.unit();
        if (i % 5 == 0) v = 1 - u; // the third weight is 0, or a unit off
        const PointOnTriangle place = inset_barycentrics(u, v, least);
        const float w = 1 - place.u - place.v;
        CHECK(min(w, min(place.u, place.v)) >= least / 1.5f - 0x1p-22f);
        CHECK(pertev::abs(place.u - u) <= 2 * least + 0x1p-22f);
        CHECK(pertev::abs(place.v - v) <= 2 * least + 0x1p-22f);
        if (u >= least && v >= least && 1 - u - v >= least) CHECK((place.u == u && place.v == v));
    }
    CHECK(inset_barycentrics(0.0f, 0.0f, 0.25f).u ==
          doctest::Approx(1.0 / 6)); // at a corner the weights are 1/4, 1/4 and 1, divided by 3/2
}
