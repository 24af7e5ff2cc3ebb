#include "formats/described/divide_triangles.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "formats/described/mapped_coordinates.h"

namespace pertev::described {
namespace {

/// The largest error of a coordinate, where 1 is the whole texture.
constexpr double kTolerance = 1.0 / 1024;
constexpr int kMostPasses = 10; // each halves edges

DoubleVec3 between(DoubleVec3 a, DoubleVec3 b, double share) {
    return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y), a.z + share * (b.z - a.z)};
}

/// Returns whether coordinates are off that are linear from a to b. It is the same from b to a, because vertices of
/// other numbers may be in the same places.
bool is_off(const TextureMapping& by, DoubleVec3 a, DoubleVec3 b) {
    if (by.kind == MappingKind::Planar) return false;
    if (std::tie(b.x, b.y, b.z) < std::tie(a.x, a.y, a.z)) std::swap(a, b);
    double Coordinates::*const around = around_of(by.kind);
    double Coordinates::*const along = by.kind == MappingKind::Spherical ? &Coordinates::s : &Coordinates::t;
    Coordinates from = coordinates_at(by, a), to = coordinates_at(by, b);
    if (from.is_on_axis) from.*around = to.*around;
    if (to.is_on_axis) to.*around = from.*around;
    const auto without_turns = [](double turns) { return turns - std::round(turns); };
    const double turn = without_turns(to.*around - from.*around);
    for (const double share : {0.25, 0.5, 0.75}) {
        const Coordinates at = coordinates_at(by, between(a, b, share));
        if (std::abs(at.*along - (from.*along + share * (to.*along - from.*along))) > kTolerance) return true;
        if (at.is_on_axis || (from.is_on_axis && to.is_on_axis)) continue;
        if (std::abs(without_turns(at.*around - (from.*around + share * turn))) > kTolerance) return true;
    }
    return false;
}

/// Appends the vertex in the middle of two.
uint32_t append_middle(Mesh& mesh, uint32_t a, uint32_t b) {
    const auto append = [&](auto& values, const auto& middle_of) {
        if (!values.empty()) values.push_back(middle_of(values[a], values[b]));
    };
    append(mesh.positions, [](Vec3 p, Vec3 q) { return to_float(between(to_double(p), to_double(q), 0.5)); });
    append(mesh.normals, [](Vec3 p, Vec3 q) {
        const Vec3 sum = p + q;
        return dot(sum, sum) > 0 ? normalize(sum) : p;
    });
    append(mesh.tangents, [](Vec4 p, Vec4 q) {
        const Vec3 sum = {p.x + q.x, p.y + q.y, p.z + q.z};
        const Vec3 unit = dot(sum, sum) > 0 ? normalize(sum) : Vec3{p.x, p.y, p.z};
        return Vec4{unit.x, unit.y, unit.z, p.w};
    });
    for (std::vector<Vec2>& set : mesh.uv)
        append(set, [](Vec2 p, Vec2 q) { return Vec2{0.5f * (p.x + q.x), 0.5f * (p.y + q.y)}; });
    append(mesh.colors, [](Vec4 p, Vec4 q) {
        return Vec4{0.5f * (p.x + q.x), 0.5f * (p.y + q.y), 0.5f * (p.z + q.z), 0.5f * (p.w + q.w)};
    });
    return static_cast<uint32_t>(mesh.positions.size() - 1);
}

/// The triangles in place of one whose edges from corner k to the next have the vertices `middles[k]`, if any. They
/// keep its order of corners.
void append_parts(const std::array<uint32_t, 3>& corners, const std::array<std::optional<uint32_t>, 3>& middles,
                  std::vector<uint32_t>& indices) {
    // Corners whose two edges are divided are cut off. What is left is a fan.
    std::vector<uint32_t> left;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::optional<uint32_t> before = middles[(k + 2) % 3], after = middles[k];
        if (before && after) {
            indices.insert(indices.end(), {*before, corners[k], *after});
        } else {
            left.push_back(corners[k]);
        }
        if (after) left.push_back(*after);
    }
    // It starts in a middle, because the one corner before and the one after that lie on a line with it.
    const auto is_middle = [&](uint32_t vertex) { return std::ranges::find(corners, vertex) == corners.end(); };
    std::ranges::rotate(left, std::ranges::find_if(left, is_middle));
    for (std::size_t k = 1; k + 1 < left.size(); ++k) indices.insert(indices.end(), {left[0], left[k], left[k + 1]});
}

} // namespace

bool divide_triangles(Mesh& mesh, const std::vector<std::shared_ptr<const TextureMapping>>& mappings,
                      const DoubleTransform& world_from_mesh, std::size_t most_triangles) {
    for (int pass = 0; pass < kMostPasses; ++pass) {
        const auto world = [&](uint32_t vertex) {
            return transform_point(world_from_mesh, to_double(mesh.positions[vertex]));
        };
        std::map<std::pair<uint32_t, uint32_t>, bool> is_divided; // by the lower vertex and the higher one
        std::size_t triangles = mesh.indices.size() / 3;
        const auto edge_of = [&](std::size_t first, std::size_t k) {
            return std::minmax({mesh.indices[first + k], mesh.indices[first + (k + 1) % 3]});
        };
        for (std::size_t first = 0; first + 2 < mesh.indices.size(); first += 3)
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [known, is_new] = is_divided.try_emplace(edge_of(first, k), false);
                if (is_new)
                    known->second = std::ranges::any_of(mappings, [&](const auto& by) {
                        return is_off(*by, world(known->first.first), world(known->first.second));
                    });
                if (known->second) ++triangles;
            }
        if (triangles == mesh.indices.size() / 3) return true;
        if (triangles > most_triangles) return false;
        std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
        std::vector<uint32_t> indices;
        for (std::size_t first = 0; first + 2 < mesh.indices.size(); first += 3) {
            std::array<std::optional<uint32_t>, 3> of_edges;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto edge = edge_of(first, k);
                if (!is_divided.at(edge)) continue;
                const auto [known, is_new] = middles.try_emplace(edge, 0);
                if (is_new) known->second = append_middle(mesh, edge.first, edge.second);
                of_edges[k] = known->second;
            }
            append_parts({mesh.indices[first], mesh.indices[first + 1], mesh.indices[first + 2]}, of_edges, indices);
        }
        mesh.indices = std::move(indices);
    }
    return true;
}

} // namespace pertev::described
