#include "device_scene/close_gaps.h"

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "device_scene/nest_solids.h"
#include "math/transform.h"

namespace pertev {
namespace {

struct TouchingSolid {
    uint32_t instance;
    Bounds3 bounds; // world
    float gap;      // that counts as touching
};

Bounds3 grown(Bounds3 bounds, float by) { return {bounds.lo - Vec3{by, by, by}, bounds.hi + Vec3{by, by, by}}; }
bool may_touch(const Bounds3& a, const Bounds3& b) {
    const Vec3 lo = max(a.lo, b.lo), hi = min(a.hi, b.hi);
    return lo.x <= hi.x && lo.y <= hi.y && lo.z <= hi.z;
}

/// Square of the distance between a point and a triangle (Ericson, "Real-Time Collision Detection", 2005, 5.1.5).
float squared_distance(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
    const auto from = [&](Vec3 q) { return length_squared(p - q); };
    const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const float d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
                d6 = dot(ac, cp);
    if (d1 <= 0 && d2 <= 0) return from(a);
    if (d3 >= 0 && d4 <= d3) return from(b);
    if (d6 >= 0 && d5 <= d6) return from(c);
    const float vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return from(a + (d1 / (d1 - d3)) * ab);
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return from(a + (d2 / (d2 - d6)) * ac);
    if (va <= 0 && d4 >= d3 && d5 >= d6) return from(b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b));
    const float whole = va + vb + vc;
    return whole > 0 ? from(a + (vb / whole) * ab + (vc / whole) * ac) : from(a);
}

/// Triangles of a mesh in the world, by the least x of their boxes.
class Triangles {
public:
    Triangles(const Scene& scene, const TouchingSolid& solid, const Bounds3& within) {
        const Instance& instance = scene.instances[solid.instance];
        const Mesh& mesh = scene.meshes[instance.mesh];
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            Corners corners;
            for (std::size_t k = 0; k < 3; ++k) {
                corners.at[k] = transform_point(instance.world_from_local, mesh.positions[mesh.indices[i + k]]);
                corners.bounds.extend(corners.at[k]);
            }
            if (!may_touch(corners.bounds, within)) continue;
            widest_ = max(widest_, corners.bounds.hi.x - corners.bounds.lo.x);
            all_.push_back(corners);
        }
        std::sort(all_.begin(), all_.end(),
                  [](const Corners& a, const Corners& b) { return a.bounds.lo.x < b.bounds.lo.x; });
    }
    bool is_near(Vec3 point, float gap) const {
        const Bounds3 around = grown({point, point}, gap);
        auto at = std::lower_bound(all_.begin(), all_.end(), around.lo.x - widest_,
                                   [](const Corners& corners, float x) { return corners.bounds.lo.x < x; });
        for (; at != all_.end() && at->bounds.lo.x <= around.hi.x; ++at) {
            if (!may_touch(at->bounds, around)) continue;
            if (squared_distance(point, at->at[0], at->at[1], at->at[2]) <= gap * gap) return true;
        }
        return false;
    }

private:
    struct Corners {
        Vec3 at[3];
        Bounds3 bounds;
    };
    std::vector<Corners> all_;
    float widest_ = 0;
};

/// Outward directions at the vertices of a closed mesh in the world: sums of the normals of all triangles at equal
/// positions, by area.
std::vector<Vec3> outward(const Mesh& mesh, const Transform& world_from_local) {
    using Key = std::tuple<float, float, float>;
    const auto key = [&](uint32_t vertex) {
        const Vec3 p = mesh.positions[vertex];
        return Key(p.x, p.y, p.z);
    };
    const float side = determinant(world_from_local) < 0 ? -1.0f : 1.0f;
    std::map<Key, Vec3> sums;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        Vec3 at[3];
        for (std::size_t k = 0; k < 3; ++k) {
            at[k] = transform_point(world_from_local, mesh.positions[mesh.indices[i + k]]);
        }
        const Vec3 normal = side * cross(at[1] - at[0], at[2] - at[0]);
        for (std::size_t k = 0; k < 3; ++k) {
            Vec3& sum = sums.try_emplace(key(mesh.indices[i + k]), Vec3{0, 0, 0}).first->second;
            sum = sum + normal;
        }
    }
    std::vector<Vec3> directions(mesh.positions.size(), Vec3{0, 0, 0});
    for (const uint32_t vertex : mesh.indices) {
        const Vec3 sum = sums.at(key(vertex));
        const float size = length(sum);
        if (size > 0) directions[vertex] = (1.0f / size) * sum;
    }
    return directions;
}

/// Returns the positions of the later solid's mesh after it has grown towards `earlier`; nothing if they do not touch.
std::optional<std::vector<Vec3>> grown_towards(const Scene& scene, const TouchingSolid& earlier,
                                               const TouchingSolid& later) {
    const Instance& instance = scene.instances[later.instance];
    const Mesh& mesh = scene.meshes[instance.mesh];
    const Triangles triangles(scene, earlier, grown(later.bounds, later.gap));
    std::vector<Vec3> directions, positions;
    const Transform local_from_world = inverse(instance.world_from_local);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3 point = transform_point(instance.world_from_local, mesh.positions[i]);
        if (!triangles.is_near(point, later.gap)) continue;
        if (positions.empty()) positions = mesh.positions, directions = outward(mesh, instance.world_from_local);
        positions[i] = transform_point(local_from_world, point + 2 * later.gap * directions[i]);
    }
    if (positions.empty()) return std::nullopt;
    return positions;
}

/// Closed solids whose boxes are near another solid's. Whether a mesh is closed takes long to find out.
std::vector<TouchingSolid> closed_solids(const Scene& scene) {
    std::vector<TouchingSolid> all, solids;
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Material& material = scene.materials[instance.material];
        if (instance.is_hidden || !material.encloses() || material.is_clear_boundary) continue;
        const Bounds3 bounds = world_bounds(scene.meshes[instance.mesh], instance.world_from_local);
        all.push_back({static_cast<uint32_t>(i), bounds, kTouching * max_component(bounds.size())});
    }
    std::map<uint32_t, bool> closed;
    for (const TouchingSolid& solid : all) {
        const bool has_neighbour = std::ranges::any_of(all, [&](const TouchingSolid& other) {
            return &other != &solid && may_touch(grown(solid.bounds, solid.gap), grown(other.bounds, other.gap));
        });
        if (!has_neighbour) continue;
        const uint32_t mesh = scene.instances[solid.instance].mesh;
        const auto [found, is_new] = closed.try_emplace(mesh);
        if (is_new) found->second = is_closed(scene.meshes[mesh]);
        if (found->second) solids.push_back(solid);
    }
    return solids;
}

} // namespace

uint32_t close_gaps(Scene& scene) {
    const auto moves = [&](uint32_t mesh) {
        return std::ranges::any_of(scene.shapes, [&](const MeshShape& shape) { return shape.mesh == mesh; });
    };
    const auto users = [&](uint32_t mesh) {
        return std::ranges::count_if(scene.instances, [&](const Instance& of) { return of.mesh == mesh; });
    };
    uint32_t count = 0;
    const std::vector<TouchingSolid> solids = closed_solids(scene);
    for (std::size_t later = 1; later < solids.size(); ++later) {
        Instance& instance = scene.instances[solids[later].instance];
        if (moves(instance.mesh)) continue;
        bool has_grown = false;
        for (std::size_t earlier = 0; earlier < later; ++earlier) {
            if (!may_touch(solids[earlier].bounds, grown(solids[later].bounds, solids[later].gap))) continue;
            const auto positions = grown_towards(scene, solids[earlier], solids[later]);
            if (!positions) continue;
            if (users(instance.mesh) > 1) {
                scene.meshes.push_back(scene.meshes[instance.mesh]);
                instance.mesh = static_cast<uint32_t>(scene.meshes.size() - 1);
            }
            scene.meshes[instance.mesh].positions = *positions;
            has_grown = true;
        }
        count += has_grown ? 1 : 0;
    }
    return count;
}

} // namespace pertev
