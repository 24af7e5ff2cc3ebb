// The rounding bound of a hit's position in device_scene/surface.h, compared with the same sums in double.

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "device_scene/surface.h"
#include "math/double_vec3.h"
#include "tests/support/random.h"

using namespace pertev;

namespace {

DoubleVec3 operator*(double s, DoubleVec3 a) { return {s * a.x, s * a.y, s * a.z}; }
double length(DoubleVec3 a) { return std::sqrt(dot(a, a)); }
DoubleVec3 turned(const Transform& m, DoubleVec3 v) {
    return {dot(to_double(m.row0), v), dot(to_double(m.row1), v), dot(to_double(m.row2), v)};
}

/// One triangle of a mesh, and its position in the world.
struct OneTriangle {
    Vec3 positions[3];
    uint32_t indices[3] = {0, 1, 2};
    InstanceView instance{};
    MeshView mesh{};

    /// Any size and shape, any distance from the origin of either space, rotated and scaled.
    OneTriangle(test::Random& random, bool is_baked) {
        const auto power = [&](int least, uint32_t count) {
            return std::ldexp(1.0f, least + static_cast<int>(random.below(count)));
        };
        const float size = power(-10, 20), away = random.below(3) == 0 ? 0.0f : power(-10, 24);
        const Vec3 middle = random.point(-away, away);
        for (Vec3& p : positions) p = middle + random.point(-size, size);
        const Vec3 axis = random.direction();
        const float half = random.below(3) == 0 ? 0.0f : random.within(-3, 3);
        const Transform turn =
            make_rotation(std::sin(half) * axis.x, std::sin(half) * axis.y, std::sin(half) * axis.z, std::cos(half));
        const Vec3 scale = {power(-3, 6), power(-3, 6), power(-3, 6)};
        const float far = random.below(3) == 0 ? 0.0f : power(-10, 24);
        instance.world_from_local =
            compose(make_translation(random.point(-far, far)), compose(turn, make_scale(scale)));
        instance.local_from_world = inverse(instance.world_from_local);
        instance.is_baked = is_baked ? 1 : 0;
        mesh.positions = positions;
        mesh.indices = indices;
    }
    OneTriangle(const OneTriangle&) = delete;
    OneTriangle& operator=(const OneTriangle&) = delete;

    WorldTriangle at(float u, float v) const {
        Hit hit;
        hit.u = u, hit.v = v, hit.primitive = 0;
        return world_triangle(instance, mesh, hit);
    }
};

/// Computes a + u (b - a) + v (c - a) in higher precision.
DoubleVec3 point_at(const Vec3 (&corners)[3], double u, double v) {
    const DoubleVec3 a = to_double(corners[0]);
    return a + (u * (to_double(corners[1]) - a) + v * (to_double(corners[2]) - a));
}

/// Returns whether the triangle is not a sliver and is much larger than its error, so that neither limits the distance
/// of points from its edges.
bool has_room(const WorldTriangle& placed) {
    const double size = static_cast<double>(max_component(max(abs(placed.ab), abs(placed.ac))));
    const double width = length(cross(to_double(placed.ab), to_double(placed.ac))) / size;
    return width > 0.07 * size && width > 300 * static_cast<double>(max_component(placed.error));
}

double part_of(DoubleVec3 off, Vec3 error) {
    const auto part = [](double x, float bound) { return x == 0 ? 0 : std::abs(x) / static_cast<double>(bound); };
    return std::max(part(off.x, error.x), std::max(part(off.y, error.y), part(off.z, error.z)));
}

} // namespace

TEST_CASE("a hit position is within its error bound of the traversed surface, baked or in an instance") {
    test::Random random(3);
    for (const bool is_baked : {true, false}) {
        CAPTURE(is_baked);
        double most = 0;
        int tried = 0;
        for (int i = 0; i < 200'000; ++i) {
            const OneTriangle one(random, is_baked);
            const float u = random.within(0.25f, 0.4f), v = random.within(0.25f, 0.4f); // no edge is near
            const WorldTriangle placed = one.at(u, v);
            if (!has_room(placed)) continue;
            ++tried;
            const Transform& m = one.instance.world_from_local;
            DoubleVec3 off;
            if (is_baked) { // the traversal has the moved corners
                const Vec3 corners[3] = {transform_point(m, one.positions[0]), transform_point(m, one.positions[1]),
                                         transform_point(m, one.positions[2])};
                off = to_double(placed.position) - point_at(corners, double(u), double(v));
            } else { // the traversal moves the origin
                const Vec3 local = transform_point(one.instance.local_from_world, placed.position);
                off = turned(m, to_double(local) - point_at(one.positions, double(u), double(v)));
            }
            most = std::max(most, part_of(off, placed.error));
        }
        CAPTURE(most);
        CHECK(most <= (is_baked ? 0.6 : 1.0)); // the rest belongs to later steps if the mesh is baked
        CHECK(most > 0.2);                     // the bound is not trivial
        CHECK(tried > 50'000);
    }
}

TEST_CASE("a hit position is kept off all edges by more than its error and moves by at most 900 times that") {
    test::Random random(5);
    double nearest = 1e30, farthest = 0;
    int kept = 0;
    for (int i = 0; i < 200'000; ++i) {
        const OneTriangle one(random, i % 2 == 0);
        const uint32_t where = random.below(3);
        const float along = random.unit();
        const float u = where == 0 ? 0.0f : where == 1 ? along : 1.0f - along;
        const float v = where == 1 ? 0.0f : along;
        const WorldTriangle placed = one.at(u, v);
        const double error = static_cast<double>(max_component(placed.error));
        const Vec3 corners[3] = {placed.a, placed.a + placed.ab, placed.a + placed.ac};
        farthest =
            std::max(farthest, length(to_double(placed.position) - point_at(corners, double(u), double(v))) / error);
        if (!has_room(placed)) continue;
        ++kept;
        for (int k = 0; k < 3; ++k) {
            const DoubleVec3 from = to_double(corners[k]), edge = to_double(corners[(k + 1) % 3]) - from;
            const double away = length(cross(to_double(placed.position) - from, edge)) / length(edge);
            nearest = std::min(nearest, away / error);
        }
    }
    CAPTURE(nearest);
    CAPTURE(farthest);
    CHECK(kept > 20'000);
    CHECK(nearest > 4.5);
    CHECK(farthest < 900);
}
