#include "formats/described/project_textures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "base/limits.h"
#include "formats/described/divide_triangles.h"
#include "formats/described/mapped_coordinates.h"
#include "formats/described/missing_coordinates.h"
#include "formats/described/transforms.h"

namespace pertev::described {
namespace {

using Mappings = std::vector<std::shared_ptr<const TextureMapping>>;
constexpr std::size_t kMaxMappings = kTextureSets - 1;
/// The most triangles that dividing them makes of a mesh with less than half as many.
constexpr uint64_t kMostTriangles = 1 << 20;

/// Appends a copy of a vertex, without its set `except`. Returns its number.
uint32_t append_copy(Mesh& mesh, uint32_t vertex, std::size_t except) {
    const auto copy = [vertex](auto& values) {
        if (values.empty()) return;
        const auto value = values[vertex]; // the array moves
        values.push_back(value);
    };
    copy(mesh.positions);
    copy(mesh.normals);
    copy(mesh.tangents);
    copy(mesh.colors);
    for (std::size_t set = 0; set < mesh.uv.size(); ++set) {
        if (set != except) copy(mesh.uv[set]);
    }
    return static_cast<uint32_t>(mesh.positions.size() - 1);
}

/// Adds a set of coordinates. Triangles at the axis and across the seam, where the angle around it is a whole turn, get
/// vertices of their own, so that they do not have the whole picture.
void add_set(Mesh& mesh, const TextureMapping& by, const DoubleTransform& world_from_mesh, std::size_t set) {
    std::vector<Coordinates> at;
    for (const Vec3& position : mesh.positions)
        at.push_back(coordinates_at(by, transform_point(world_from_mesh, to_double(position))));
    if (by.kind != MappingKind::Planar) {
        double Coordinates::*const around = around_of(by.kind);
        const auto moved = [&](uint32_t vertex, double to) {
            at.push_back(at[vertex]);
            at.back().*around = to;
            return append_copy(mesh, vertex, set);
        };
        std::map<uint32_t, uint32_t> a_turn_later;
        for (std::size_t first = 0; first + 2 < mesh.indices.size(); first += 3) {
            double least = kInfinity, greatest = -kInfinity, sum = 0;
            int count = 0;
            const auto visit_off_axis = [&](const auto& visit) {
                for (std::size_t k = first; k < first + 3; ++k) {
                    if (!at[mesh.indices[k]].is_on_axis) visit(mesh.indices[k]);
                }
            };
            visit_off_axis([&](uint32_t& vertex) {
                least = std::min(least, at[vertex].*around), greatest = std::max(greatest, at[vertex].*around);
            });
            visit_off_axis([&](uint32_t& vertex) {
                const double own = at[vertex].*around;
                if (greatest - least > 0.5 && own < greatest - 0.5) {
                    const auto [known, is_new] = a_turn_later.try_emplace(vertex, 0);
                    if (is_new) known->second = moved(vertex, own + 1);
                    vertex = known->second;
                }
                sum += at[vertex].*around, ++count;
            });
            if (count == 0 || count == 3) continue;
            for (std::size_t k = first; k < first + 3; ++k) {
                uint32_t& vertex = mesh.indices[k];
                if (at[vertex].is_on_axis) vertex = moved(vertex, sum / count);
            }
        }
    }
    std::vector<Vec2>& uv = mesh.uv[set];
    uv.clear();
    const auto usable = [](double x) { return std::isfinite(static_cast<float>(x)) ? static_cast<float>(x) : 0.0f; };
    for (const Coordinates& c : at) uv.push_back({usable(c.s), usable(1 - c.t)}); // v points down
}

/// Surfaces and opacities that use the coordinates of meshes in place of mappings, by those that do not.
struct WithoutMappings {
    std::map<uint32_t, uint32_t> surfaces, alphas;

    void use_in(Parts& parts, Placed& shape) {
        const auto take = [](std::map<uint32_t, uint32_t>& known, auto& all, uint32_t& number, const auto& make) {
            const auto [plain, is_new] = known.try_emplace(number, static_cast<uint32_t>(all.size()));
            if (is_new) all.push_back(make(all[number]));
            number = plain->second;
        };
        take(surfaces, parts.surfaces, shape.surface, [](Surface surface) {
            for (SlotImage& image : surface.images) {
                image.mapping.reset();
                (surface.material.*image.slot).uv_set = 0;
            }
            return surface;
        });
        if (!shape.alpha || !parts.alphas[*shape.alpha].mapping) return;
        take(alphas, parts.alphas, *shape.alpha, [](TextureValue alpha) {
            alpha.mapping.reset();
            return alpha;
        });
    }
};

/// Returns the mesh with sets of coordinates by these mappings, from 1 on, or nothing if it takes more than `left`
/// bytes.
std::optional<ShapeMesh> with_sets(const Parts& parts, const Placed& shape, const Mappings& sets,
                                   const DoubleTransform& world_from_mesh, uint64_t& left, Sink& sink) {
    const ShapeMesh& from = parts.meshes[shape.mesh];
    // Every corner may get a vertex of its own for each set, and a vertex divides an edge.
    constexpr uint64_t kVertexBytes = 3 * sizeof(Vec4) + kTextureSets * sizeof(Vec2) + sizeof(uint32_t);
    const uint64_t of_triangle = 3 * sets.size() + 2;
    const auto bytes_of = [&](const Mesh& mesh) {
        return sizeof(ShapeMesh) + kVertexBytes * (mesh.positions.size() + of_triangle * mesh.triangle_count());
    };
    if (bytes_of(from.mesh) > left) {
        sink.leave_out({from.location, "the mapping of a texture is left out; uv is used"});
        return std::nullopt;
    }
    ShapeMesh made = from;
    give_missing_coordinates(parts, shape, made);
    // A power is that of each of the file's triangles.
    const bool has_power = shape.area_light && parts.area_lights[*shape.area_light].power > 0 && !from.is_quadric;
    const uint64_t most =
        has_power ? 0 : (left - std::min(left, bytes_of(made.mesh))) / (kVertexBytes * (of_triangle + 2));
    if (!divide_triangles(made.mesh, sets, world_from_mesh,
                          std::min(most, std::max<uint64_t>(kMostTriangles, 2 * made.mesh.triangle_count()))))
        sink.warn({from.location, "the mapping of a texture is linear across large triangles"});
    left -= std::min(bytes_of(made.mesh), left);
    for (std::size_t k = 0; k < sets.size(); ++k) add_set(made.mesh, *sets[k], world_from_mesh, k + 1);
    return made;
}

} // namespace

Mappings number_mappings(Surface& surface) {
    Mappings sets;
    for (const SlotImage& image : surface.images) {
        if (!image.mapping) continue;
        const auto known = std::ranges::find_if(sets, [&](const auto& other) { return *other == *image.mapping; });
        const auto number = static_cast<std::size_t>(known - sets.begin());
        if (known == sets.end() && number < kMaxMappings) sets.push_back(image.mapping);
        (surface.material.*image.slot).uv_set = number < kMaxMappings ? static_cast<uint8_t>(number + 1) : 0;
    }
    return sets;
}

void project_textures(Parts& parts, uint64_t file_bytes, Sink& sink) {
    const auto has_mapping = [](const SlotImage& image) { return image.mapping != nullptr; };
    for (Surface& surface : parts.surfaces) number_mappings(surface);
    using Place = std::array<double, 12>;
    std::map<std::tuple<uint32_t, Place, std::vector<const TextureMapping*>, bool>, uint32_t> known;
    uint64_t left = justified_bytes(kFreeMeshBytes, file_bytes);
    WithoutMappings without;
    for (Placed& shape : parts.placed) {
        const bool has_alpha = shape.alpha && parts.alphas[*shape.alpha].mapping;
        if (!has_alpha && std::ranges::none_of(parts.surfaces[shape.surface].images, has_mapping)) continue;
        const ShapeMesh& from = parts.meshes[shape.mesh];
        const DoubleTransform m = compose(shape.world_from_mesh, from.shape_from_mesh);
        if (from.mesh.indices.empty() || !is_finite(m)) continue; // nothing of it is drawn
        Surface surface = parts.surfaces[shape.surface];
        if (shape.alpha) set_alpha(surface, parts.alphas[*shape.alpha]);
        const Mappings sets = number_mappings(surface);
        const auto numbers = [](DoubleVec3 a, DoubleVec3 b, DoubleVec3 c, DoubleVec3 d) {
            return Place{a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z};
        };
        std::vector<const TextureMapping*> pointers;
        for (const auto& mapping : sets) pointers.push_back(mapping.get());
        const auto [copy, is_new] = known.try_emplace({shape.mesh, numbers(m.row0, m.row1, m.row2, m.translation),
                                                       pointers, lacks_coordinates(parts, shape, from)},
                                                      shape.mesh);
        if (is_new) {
            const auto is_left_out = [&](const SlotImage& image) {
                return has_mapping(image) && (surface.material.*image.slot).uv_set == 0;
            };
            if (std::ranges::any_of(surface.images, is_left_out))
                sink.leave_out({from.location, "a fourth mapping of one material is left out; uv is used"});
            if (std::optional<ShapeMesh> made = with_sets(parts, shape, sets, m, left, sink)) {
                copy->second = static_cast<uint32_t>(parts.meshes.size());
                parts.meshes.push_back(*std::move(made));
            }
        }
        if (copy->second == shape.mesh) {
            without.use_in(parts, shape);
        } else {
            shape.mesh = copy->second;
        }
    }
}

} // namespace pertev::described
