#include "session/survey/surroundings.h"

#include <array>

#include "math/portable_math.h"
#include "session/survey/cast_rays.h"

namespace pertev {
namespace {

constexpr uint64_t kMaxTriangles = 8'000'000; // half a second on one core
constexpr int kAxes = 6;                      // +x -x +y -y +z -z
constexpr int kUp = 2;
constexpr float kMaxOutsideShare = 0.12f; // share seen from outside: Sponza 0.00, Sibenik 0.03, a shoe 0.23

Vec3 axis_direction(int axis) {
    const float sign = axis % 2 == 0 ? 1.0f : -1.0f;
    return {axis / 2 == 0 ? sign : 0, axis / 2 == 1 ? sign : 0, axis / 2 == 2 ? sign : 0};
}

/// Five directions: the axis, and half-way to its four neighbours, slightly rotated so that no ray runs along an edge
/// of a box.
std::array<Vec3, 5> bundle(int axis) {
    const Vec3 d = axis_direction(axis);
    const Vec3 side = {d.y, d.z, d.x}, up = {d.z, d.x, d.y};
    return {normalize(d + 0.02f * side + 0.013f * up), normalize(d + 0.41f * side + 0.05f * up),
            normalize(d - 0.38f * side - 0.07f * up), normalize(d + 0.43f * up - 0.06f * side),
            normalize(d - 0.37f * up + 0.04f * side)};
}

/// Hits from a point along each axis.
struct RayHits {
    std::array<int, kAxes> hits = {}; // out of 5 rays
    int all = 0, front = 0;

    bool is_closed(int axis) const { return hits[static_cast<std::size_t>(axis)] >= 4; }
    bool is_open(int axis) const { return hits[static_cast<std::size_t>(axis)] <= 1; }
    int closed_sides() const {
        int count = 0;
        for (int axis = 0; axis < kAxes; ++axis) count += is_closed(axis);
        return count;
    }
    /// Returns whether the point is outside of solids, inside which every surface shows its back.
    bool is_in_the_open() const { return 2 * front >= all; }
};

std::vector<RayHits> cast_visibility_rays(const Scene& scene, const std::vector<Vec3>& points) {
    std::vector<SurveyRay> rays;
    for (const Vec3 point : points) {
        for (int axis = 0; axis < kAxes; ++axis) {
            for (const Vec3 direction : bundle(axis)) rays.push_back({point, direction});
        }
    }
    const std::vector<SurveyHit> hits = cast_rays(scene, rays, Backs::All, Glass::LetsThrough);
    std::vector<RayHits> all_hits(points.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
        RayHits& hits_there = all_hits[i / (5 * kAxes)];
        if (!hits[i].is_hit()) continue;
        ++hits_there.hits[i / 5 % kAxes];
        ++hits_there.all;
        hits_there.front += hits[i].is_front;
    }
    return all_hits;
}

/// Returns whether a box is thinner than any room: a panel, whose two sheets see each other.
bool is_flat(Vec3 size) { return min(size.x, min(size.y, size.z)) < 0.04f * max_component(size); }

bool is_long(Vec3 size) { return max(size.x, size.z) > 1.25f * min(size.x, size.z); }

/// Share of rays that hit nothing, among rays that leave the fronts of some triangles, slightly upwards to all sides.
/// It is small for a room, most of whose surfaces face inwards, but not for a shoe or a boat, which are hollow too.
float share_seen_from_outside(const Scene& scene, uint64_t triangles) {
    constexpr uint64_t kVisited = 24;
    constexpr int kWays = 8;
    const float size = max_component(bounds_of(scene).size());
    std::vector<SurveyRay> rays;
    uint64_t before = 0, next = 0; // triangles of the previous instances; the next triangle to test
    int all = 0;
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[instance.mesh];
        const uint64_t count = mesh.triangle_count();
        const float sign = is_mirroring(instance.world_from_local) ? -1.0f : 1.0f;
        for (; next < kVisited; ++next) {
            const uint64_t number = (2 * next + 1) * triangles / (2 * kVisited);
            if (number >= before + count) break;
            if (instance.is_hidden || instance.is_background) continue;
            const uint32_t* index = mesh.indices.data() + 3 * (number - before);
            const auto corner = [&](int i) {
                return transform_point(instance.world_from_local, mesh.positions[index[i]]);
            };
            const Vec3 a = corner(0), b = corner(1), c = corner(2), across = sign * cross(b - a, c - a);
            if (!(length(across) > 0)) continue;
            const Vec3 normal = normalize(across), from = (1.0f / 3) * (a + b + c) + (1e-4f * size) * normal;
            all += kWays;
            for (int k = 0; k < kWays; ++k) {
                const float turn = (static_cast<float>(k) + 0.38f) * (kTwoPi / kWays);
                const Vec3 direction = normalize(Vec3{sin(turn), 0.08f, cos(turn)}); // five degrees upwards
                if (dot(direction, normal) > 0.05f) rays.push_back({from, direction});
            }
        }
        before += count;
    }
    int free = 0;
    for (const SurveyHit& hit : cast_rays(scene, rays, Backs::All, Glass::LetsThrough)) free += !hit.is_hit();
    return all > 0 ? static_cast<float>(free) / static_cast<float>(all) : 0;
}

} // namespace

Surroundings survey_surroundings(const Scene& scene) {
    Surroundings result;
    result.bounds = bounds_of(scene);
    uint64_t triangles = 0;
    for (const Instance& instance : scene.instances) triangles += scene.meshes[instance.mesh].triangle_count();
    const Vec3 centre = result.bounds.centre(), size = result.bounds.size();
    if (triangles > kMaxTriangles || result.bounds.is_empty() || is_flat(size)) return result;

    const Vec3 along = size.x >= size.z ? Vec3{0.2f * size.x, 0, 0} : Vec3{0, 0, 0.2f * size.z};
    const Vec3 down = {0, 0.2f * size.y, 0};
    const std::vector<Vec3> points = {centre, centre - down, centre - down + along, centre - down - along};
    const std::vector<RayHits> all_hits = cast_visibility_rays(scene, points);

    int rooms = 0, escaped_rays = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const RayHits& hits_there = all_hits[i];
        if (!hits_there.is_in_the_open()) continue;
        const int closed = hits_there.closed_sides();
        if (closed == kAxes || (closed == kAxes - 1 && !hits_there.is_closed(kUp) && is_long(size))) {
            if (rooms++ == 0) result.inside = points[i];
            escaped_rays += 5 * kAxes - hits_there.all;
        }
        for (int axis = 0; axis < kAxes; ++axis) {
            if (axis / 2 != 1 && closed == kAxes - 1 && hits_there.is_open(axis)) {
                result.kind = SurroundingsKind::Stage;
                result.open_side = axis_direction(axis);
            }
        }
    }
    if (rooms >= 2 && share_seen_from_outside(scene, triangles) < kMaxOutsideShare) {
        result.kind = SurroundingsKind::Room;
        result.is_dark = escaped_rays == 0;
    }
    return result;
}

} // namespace pertev
