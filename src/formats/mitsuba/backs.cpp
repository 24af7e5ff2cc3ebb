#include "formats/mitsuba/backs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>

#include "formats/described/transforms.h"
#include "math/double_bounds3.h"
#include "scene/position_bounds.h"

namespace pertev::mitsuba {
namespace {

using described::Placed;
using described::ShapeMesh;
using described::Surface;

constexpr uint64_t kMostTests = 1 << 26; // pairs of a point and a triangle, for all shapes

uint64_t mixed(uint64_t x) { // splitmix64's finish
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
    x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
    return x ^ (x >> 31);
}

uint64_t hash_of(Vec3 p) {
    const auto bits = [](float x) { return uint64_t{std::bit_cast<uint32_t>(x + 0.0f)}; }; // -0 becomes 0
    return mixed(mixed(bits(p.x) + 0x9e3779b97f4a7c15) ^ (bits(p.y) << 32 | bits(p.z)));
}

enum class Closure { Open, Outwards, Inwards };

/// Returns whether each edge of a mesh is there as often in one direction as in the other, and then whether the front
/// is outside. A sum over all edges of numbers with the direction's sign is 0 by chance once in 2^64 open meshes.
Closure closure_of(const Mesh& mesh) {
    std::vector<uint64_t> hashes;
    hashes.reserve(mesh.positions.size());
    for (const Vec3 p : mesh.positions) hashes.push_back(hash_of(p));
    uint64_t sum = 0;
    double volume = 0;
    const DoubleVec3 middle = to_double(bounds_of(mesh).centre());
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const uint32_t* const corner = mesh.indices.data() + i;
        for (int k = 0; k < 3; ++k) {
            const uint64_t a = hashes[corner[k]], b = hashes[corner[(k + 1) % 3]];
            if (a < b) sum += mixed(a ^ std::rotl(b, 21));
            if (b < a) sum -= mixed(b ^ std::rotl(a, 21));
        }
        const auto at = [&](int k) { return to_double(mesh.positions[corner[k]]) - middle; };
        volume += dot(at(0), cross(at(1), at(2)));
    }
    if (sum != 0 || volume == 0) return Closure::Open;
    return volume > 0 ? Closure::Outwards : Closure::Inwards;
}

struct WorldTriangle {
    DoubleVec3 a, b, c;
    DoubleVec3 normal() const { return cross(b - a, c - a); }
};

/// Calls use(triangle) for the triangles of a shape in the world, with their fronts to the left, until it returns
/// false. Returns whether it was called for all.
template <class Use>
bool each_triangle(const Placed& shape, const ShapeMesh& mesh, const Use& use) {
    const DoubleTransform transform = compose(shape.world_from_mesh, mesh.shape_from_mesh);
    const bool is_mirrored = described::determinant(transform) < 0;
    const auto& indices = mesh.mesh.indices;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const auto at = [&](std::size_t k) {
            return transform_point(transform, to_double(mesh.mesh.positions[indices[i + k]]));
        };
        const WorldTriangle triangle = {at(0), is_mirrored ? at(2) : at(1), is_mirrored ? at(1) : at(2)};
        if (!use(triangle)) return false;
    }
    return true;
}

/// Adds the corners of the box of a shape's mesh, in the world.
void add_corners(const Placed& shape, const ShapeMesh& mesh, std::vector<DoubleVec3>& to) {
    const DoubleTransform transform = compose(shape.world_from_mesh, mesh.shape_from_mesh);
    const Bounds3 local = bounds_of(mesh.mesh);
    if (local.is_empty()) return;
    const DoubleVec3 lo = to_double(local.lo), hi = to_double(local.hi);
    for (int i = 0; i < 8; ++i)
        to.push_back(transform_point(
            transform, {(i & 1) != 0 ? hi.x : lo.x, (i & 2) != 0 ? hi.y : lo.y, (i & 4) != 0 ? hi.z : lo.z}));
}

/// Returns whether a point is inside of a closed shape, by the triangles that a ray from it crosses.
bool encloses(const Placed& shape, const ShapeMesh& mesh, DoubleVec3 point) {
    const DoubleVec3 direction = {0.5377, 0.2891, 0.7920}; // along no axis
    bool is_inside = false;
    each_triangle(shape, mesh, [&](const WorldTriangle& t) {
        const DoubleVec3 e1 = t.b - t.a, e2 = t.c - t.a, p = cross(direction, e2), from = point - t.a;
        const double det = dot(e1, p);
        if (det == 0) return true;
        const DoubleVec3 q = cross(from, e1);
        const double u = dot(from, p) / det, v = dot(direction, q) / det;
        if (u >= 0 && v >= 0 && u + v < 1 && dot(e2, q) / det > 0) is_inside = !is_inside;
        return true;
    });
    return is_inside;
}

/// Returns whether all points lie in front of each triangle of a shape, or in its plane. Meshes with many triangles
/// before many points, for which too few tests are left, count as others.
bool are_in_front(const std::vector<DoubleVec3>& points, double slack, const Placed& shape, const ShapeMesh& mesh,
                  uint64_t& tests_left) {
    const uint64_t tests = uint64_t{mesh.mesh.triangle_count()} * points.size();
    if (tests > tests_left) return false;
    tests_left -= tests;
    return each_triangle(shape, mesh, [&](const WorldTriangle& t) {
        const DoubleVec3 n = t.normal();
        const double least = -slack * std::sqrt(dot(n, n));
        return std::ranges::all_of(points, [&](DoubleVec3 p) { return dot(n, p - t.a) >= least; });
    });
}

bool is_one_sided(const Surface& surface) {
    return surface.is_one_sided || std::ranges::any_of(surface.beneath, &Surface::is_one_sided);
}

} // namespace

VisibleBacks find_visible_backs(const Parts& parts, std::span<const DoubleVec3> sensors) {
    VisibleBacks found;
    const auto concerns = [&](const Placed& shape) {
        return is_one_sided(parts.surfaces[shape.surface]) && !parts.meshes[shape.mesh].mesh.indices.empty();
    };
    if (std::ranges::none_of(parts.placed, concerns)) return found;
    std::vector<DoubleVec3> points(sensors.begin(), sensors.end());
    for (const Placed& shape : parts.placed) add_corners(shape, parts.meshes[shape.mesh], points);
    for (const described::PlacedLight& light : parts.lights) {
        if (parts_of(light.light.kind).position) points.push_back(light.position);
    }
    DoubleBounds3 all;
    for (const DoubleVec3 point : points) all.extend(point);
    const double slack = all.is_empty() ? 0 : 1e-5 * std::sqrt(dot(all.hi - all.lo, all.hi - all.lo));
    std::map<uint32_t, Closure> closures; // by mesh
    uint64_t tests_left = kMostTests;
    for (std::size_t i = 0; i < parts.placed.size(); ++i) {
        const Placed& shape = parts.placed[i];
        if (!concerns(shape)) continue;
        const ShapeMesh& mesh = parts.meshes[shape.mesh];
        const auto [known, is_new] = closures.try_emplace(shape.mesh);
        if (is_new) known->second = closure_of(mesh.mesh);
        const Closure closure = known->second;
        const bool is_cut_out = parts.surfaces[shape.surface].material.alpha_mode != AlphaMode::Opaque;
        const auto is_before = [&](DoubleVec3 sensor) {
            std::vector<DoubleVec3> corners;
            add_corners(shape, mesh, corners);
            DoubleBounds3 box;
            for (const DoubleVec3 corner : corners) box.extend(corner);
            const bool is_near = sensor.x > box.lo.x && sensor.x < box.hi.x && sensor.y > box.lo.y &&
                                 sensor.y < box.hi.y && sensor.z > box.lo.z && sensor.z < box.hi.z;
            return (is_near && encloses(shape, mesh, sensor)) == (closure == Closure::Inwards);
        };
        if (closure != Closure::Open && !is_cut_out && std::ranges::all_of(sensors, is_before) &&
            (!sensors.empty() || closure == Closure::Outwards))
            continue;
        if (are_in_front(points, slack, shape, mesh, tests_left)) continue;
        if (found.count++ == 0) found.first = i;
    }
    return found;
}

} // namespace pertev::mitsuba
