#include "formats/described/inner_boundaries.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <numeric>

#include "formats/described/described_medium.h"
#include "formats/mesh/smooth_normals.h"

namespace pertev::described {
namespace {

/// The distance between a surface and the boundary inside of it, over the diagonal of the mesh's box: rays that a
/// surface scatters begin nearer to it.
constexpr float kDistance = 0x1p-13f;

/// Returns the mesh with one vertex at each position, moved inwards.
Mesh moved_inwards(const Mesh& mesh) {
    const auto bits_of = [&](uint32_t i) {
        const Vec3 p = mesh.positions[i] + Vec3{0, 0, 0}; // -0 becomes 0
        return std::array{std::bit_cast<uint32_t>(p.x), std::bit_cast<uint32_t>(p.y), std::bit_cast<uint32_t>(p.z)};
    };
    std::vector<uint32_t> order(mesh.positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order,
                      [&](uint32_t a, uint32_t b) { return std::pair(bits_of(a), a) < std::pair(bits_of(b), b); });
    Mesh inner;
    inner.name = mesh.name;
    inner.origin = mesh.origin;
    std::vector<uint32_t> numbers(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i == 0 || bits_of(order[i]) != bits_of(order[i - 1])) inner.positions.push_back(mesh.positions[order[i]]);
        numbers[order[i]] = static_cast<uint32_t>(inner.positions.size() - 1);
    }
    for (const uint32_t i : mesh.indices) inner.indices.push_back(numbers[i]);
    const std::vector<Vec3> normals = angle_weighted_normals(inner);
    const float distance = kDistance * length(bounds_of(inner).size());
    for (std::size_t i = 0; i < normals.size(); ++i) inner.positions[i] = inner.positions[i] - distance * normals[i];
    return inner;
}

} // namespace

bool is_passed_straight(const Surface& surface) {
    const Material& material = surface.material;
    return !surface.is_nothing && surface.beneath.empty() && !is_entered(surface) &&
           (material.alpha_mode != AlphaMode::Opaque || (material.transmits() && material.thin_walled));
}

void add_inner_boundaries(Parts& parts) {
    std::map<uint32_t, uint32_t> boundaries; // by the shape's mesh
    std::optional<uint32_t> nothing;
    const std::size_t count = parts.placed.size();
    for (std::size_t i = 0; i < count; ++i) {
        Placed& shape = parts.placed[i];
        if (!shape.medium || !parts.media[*shape.medium].is_there() ||
            !is_passed_straight(parts.surfaces[shape.surface]))
            continue;
        if (parts.meshes[shape.mesh].mesh.indices.empty()) continue;
        const auto [known, is_new] = boundaries.try_emplace(shape.mesh, static_cast<uint32_t>(parts.meshes.size()));
        if (is_new) {
            const ShapeMesh& from = parts.meshes[shape.mesh];
            ShapeMesh inner;
            inner.mesh = moved_inwards(from.mesh);
            inner.shape_from_mesh = from.shape_from_mesh;
            inner.location = from.location;
            parts.meshes.push_back(std::move(inner));
        }
        if (!nothing) {
            nothing = static_cast<uint32_t>(parts.surfaces.size());
            Surface surface;
            surface.is_nothing = true;
            surface.material.name = "medium";
            parts.surfaces.push_back(std::move(surface));
        }
        Placed boundary;
        boundary.name = shape.name + " medium";
        boundary.mesh = known->second, boundary.surface = *nothing;
        boundary.medium = shape.medium, boundary.outside = shape.outside;
        boundary.world_from_mesh = shape.world_from_mesh;
        shape.medium.reset(), shape.outside.reset();
        parts.placed.push_back(std::move(boundary));
    }
}

} // namespace pertev::described
