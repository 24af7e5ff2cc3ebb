#include "device_scene/nest_solids.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "base/parallel_for.h"
#include "math/double_vec3.h"
#include "math/transform.h"

namespace pertev {
namespace {

constexpr std::size_t kMostRanks = 0xffff;
constexpr std::size_t kLookedAt = 64; // corners of a solid

/// Returns a number for each corner of the mesh; corners at equal positions have equal ones.
std::vector<uint32_t> numbered_corners(const Mesh& mesh) {
    std::vector<uint32_t> order(mesh.indices.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto position = [&](uint32_t corner) { return mesh.positions[mesh.indices[corner]]; };
    const auto key = [&](uint32_t corner) {
        const Vec3 p = position(corner);
        return std::tuple(p.x, p.y, p.z);
    };
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    std::vector<uint32_t> numbers(order.size());
    for (std::size_t i = 1; i < order.size(); ++i) {
        numbers[order[i]] = numbers[order[i - 1]] + (key(order[i]) == key(order[i - 1]) ? 0 : 1);
    }
    return numbers;
}

/// Returns whether the boxes share a volume.
bool overlap(const Bounds3& a, const Bounds3& b) {
    const Vec3 lo = max(a.lo, b.lo), hi = min(a.hi, b.hi);
    return lo.x < hi.x && lo.y < hi.y && lo.z < hi.z;
}
bool contains(const Bounds3& bounds, Vec3 p) {
    return p.x >= bounds.lo.x && p.x <= bounds.hi.x && p.y >= bounds.lo.y && p.y <= bounds.hi.y && p.z >= bounds.lo.z &&
           p.z <= bounds.hi.z;
}

/// Directions of three lines from a point. Two of them decide, because one may meet an edge.
constexpr DoubleVec3 kDirections[] = {{0.5773, 0.5221, 0.6279}, {-0.3117, 0.8891, -0.3353}, {0.1213, -0.4391, 0.8903}};

} // namespace

Bounds3 world_bounds(const Mesh& mesh, const Transform& world_from_local) {
    Bounds3 bounds;
    for (const uint32_t vertex : mesh.indices) {
        bounds.extend(transform_point(world_from_local, mesh.positions[vertex]));
    }
    return bounds;
}

bool is_closed(const Mesh& mesh) {
    const std::vector<uint32_t> corners = numbered_corners(mesh);
    std::vector<uint64_t> forwards, backwards;
    forwards.reserve(corners.size()), backwards.reserve(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const uint64_t from = corners[i], to = corners[i % 3 == 2 ? i - 2 : i + 1];
        if (from == to) continue;
        forwards.push_back(from << 32 | to);
        backwards.push_back(to << 32 | from);
    }
    std::sort(forwards.begin(), forwards.end());
    std::sort(backwards.begin(), backwards.end());
    return !forwards.empty() && forwards == backwards;
}

std::shared_ptr<const ClosedMeshes::Shape> ClosedMeshes::shape_of(const Scene& scene, uint32_t mesh) {
    const auto [found, is_new] = found_.try_emplace(mesh);
    if (is_new && is_closed(scene.meshes[mesh])) {
        Shape shape = {scene.meshes[mesh].positions, scene.meshes[mesh].indices, {}};
        for (const DoubleVec3& direction : kDirections)
            shape.lines.emplace_back(shape.positions, shape.indices, direction);
        found->second = std::make_shared<const Shape>(std::move(shape));
    }
    return found->second;
}

NestedSolids::NestedSolids(const Scene& scene, Vec3 centre) {
    ClosedMeshes closed;
    *this = NestedSolids(scene, centre, closed);
}

NestedSolids::NestedSolids(const Scene& scene, Vec3 centre, ClosedMeshes& closed) : centre_(centre) {
    for (std::size_t i = 0; i < scene.instances.size(); ++i) {
        const Instance& instance = scene.instances[i];
        const Material& material = scene.materials[instance.material];
        if (instance.is_hidden || instance.is_background || !material.encloses()) continue;
        solids_.push_back({.instance = static_cast<uint32_t>(i),
                           .shape = nullptr,
                           .world_from_local = instance.world_from_local,
                           .local_from_world = inverse(instance.world_from_local),
                           .bounds = world_bounds(scene.meshes[instance.mesh], instance.world_from_local),
                           .priority = material.priority,
                           .is_clear = material.is_clear_boundary});
    }
    const bool keeps_all = has_media(scene);
    std::sort(solids_.begin(), solids_.end(),
              [](const Solid& a, const Solid& b) { return a.bounds.lo.x < b.bounds.lo.x; });
    const auto keep_overlapping = [&] {
        if (keeps_all) return;
        std::vector<bool> is_kept(solids_.size());
        for (std::size_t i = 0; i < solids_.size(); ++i) {
            for (std::size_t k = i + 1; k < solids_.size() && solids_[k].bounds.lo.x < solids_[i].bounds.hi.x; ++k) {
                if (overlap(solids_[i].bounds, solids_[k].bounds)) is_kept[i] = is_kept[k] = true;
            }
        }
        std::size_t at = 0;
        std::erase_if(solids_, [&](const Solid&) { return !is_kept[at++]; });
    };
    keep_overlapping(); // before meshes are looked at, which takes longer
    for (Solid& solid : solids_) solid.shape = closed.shape_of(scene, scene.instances[solid.instance].mesh);
    std::erase_if(solids_, [&](const Solid& solid) {
        const Material& material = scene.materials[scene.instances[solid.instance].material];
        const bool has_medium = material.is_clear_boundary || material.medium.is_there();
        return solid.shape == nullptr && !(keeps_all && has_medium);
    });
    keep_overlapping();
    if (solids_.empty()) return;
    parallel_for(solids_.size(), 1, [&](uint64_t i) {
        const Solid& outer = solids_[i];
        const auto lo = [](const Solid& solid) { return solid.bounds.lo.x; };
        for (auto inner = std::ranges::lower_bound(solids_, lo(outer), {}, lo);
             inner != solids_.end() && lo(*inner) <= outer.bounds.hi.x; ++inner) {
            if (&outer == &*inner || !holds(outer, *inner, scene.meshes[scene.instances[inner->instance].mesh]))
                continue;
            std::atomic_ref(inner->depth).fetch_add(1, std::memory_order_relaxed);
        }
    });
    std::sort(solids_.begin(), solids_.end(), [](const Solid& a, const Solid& b) {
        return std::tuple(a.priority, a.depth, !a.is_clear, b.instance) <
               std::tuple(b.priority, b.depth, !b.is_clear, a.instance);
    });
    if (solids_.size() > kMostRanks) solids_.resize(kMostRanks); // others are in a vacuum
    ranks_.resize(scene.instances.size());
    instances_.resize(1);
    for (const Solid& solid : solids_) {
        ranks_[solid.instance] = static_cast<uint16_t>(instances_.size());
        instances_.push_back(solid.instance);
    }
}

/// Returns whether the line from a point meets the mesh more often from inside than from outside, or the other way.
bool NestedSolids::holds(const Solid& solid, Vec3 point) const {
    if (solid.shape == nullptr || !contains(solid.bounds, point)) return false;
    const ClosedMeshes::Shape& shape = *solid.shape;
    const DoubleVec3 from = to_double(transform_point(solid.local_from_world, point));
    int votes = 0;
    for (const LineCrossings& line : shape.lines) {
        votes += line.count(shape.positions, shape.indices, from) != 0 ? 1 : 0;
        if (votes == 2) break;
    }
    return votes >= 2;
}

/// Returns whether two of three vertices of its mesh, which may be open, are inside another solid whose box holds the
/// whole of it.
bool NestedSolids::holds(const Solid& outer, const Solid& inner, const Mesh& mesh) const {
    if (!contains(outer.bounds, inner.bounds.lo) || !contains(outer.bounds, inner.bounds.hi)) return false;
    const std::vector<Vec3>& positions = inner.shape != nullptr ? inner.shape->positions : mesh.positions;
    const std::vector<uint32_t>& indices = inner.shape != nullptr ? inner.shape->indices : mesh.indices;
    const std::size_t count = indices.size();
    int votes = 0;
    for (const std::size_t corner : {std::size_t(0), count / 3, 2 * count / 3}) {
        votes += holds(outer, transform_point(inner.world_from_local, positions[indices[corner]])) ? 1 : 0;
    }
    return votes >= 2;
}

InteriorList NestedSolids::at(Vec3 point) const {
    InteriorList list;
    for (std::size_t i = 0; i < solids_.size(); ++i) {
        if (holds(solids_[i], point + centre_)) list = list.with(static_cast<uint32_t>(i + 1));
    }
    return list;
}

bool NestedSolids::is_nested() const {
    return std::ranges::any_of(solids_, [&](const Solid& inner) {
        if (inner.shape == nullptr || inner.is_clear) return false;
        const ClosedMeshes::Shape& shape = *inner.shape;
        const std::size_t step = std::max<std::size_t>(shape.indices.size() / kLookedAt, 1);
        for (std::size_t corner = 0; corner < shape.indices.size(); corner += step) {
            const Vec3 point = transform_point(inner.world_from_local, shape.positions[shape.indices[corner]]);
            for (const Solid& outer : solids_) {
                if (outer.instance != inner.instance && !outer.is_clear && holds(outer, point)) return true;
            }
        }
        return false;
    });
}

} // namespace pertev
