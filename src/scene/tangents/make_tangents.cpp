#include "scene/tangents/make_tangents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/parallel_for.h"
#include "math/double_vec3.h"
#include "scene/node.h"
#include "scene/shape_mesh.h"
#include "scene/tangents/corner_tangents.h"
#include "scene/tangents/split_vertices.h"

namespace pertev {
namespace {

/// The vertices of a mesh, or each of its corners separately if it has no normals, which then come from the
/// triangles.
class Vertices {
public:
    /// `indices` have the file's winding. Both outlive this object.
    Vertices(std::span<const uint32_t> indices, std::span<const Vec2> uv, bool has_normals)
        : has_normals_(has_normals), indices_(indices), uv_(uv) {
        if (has_normals) return;
        corner_uv_ = expanded(uv);
        corner_numbers_.resize(indices.size());
        for (std::size_t i = 0; i < indices.size(); ++i) corner_numbers_[i] = static_cast<uint32_t>(i);
    }

    /// Returns the mesh with its vertices at these positions; normals have any length but 0. The result is valid until
    /// the next call, and as long as `positions`.
    TangentMesh at(std::span<const Vec3> positions, std::span<const Vec3> normals) {
        if (has_normals_) {
            normals_.resize(normals.size());
            for (std::size_t i = 0; i < normals.size(); ++i) normals_[i] = unit_or_up(normals[i]);
            return {.positions = positions, .normals = normals_, .uv = uv_, .indices = indices_};
        }
        corner_positions_ = expanded(positions);
        normals_.resize(corner_positions_.size());
        for (std::size_t i = 0; i < normals_.size(); i += 3) {
            const DoubleVec3 a = to_double(corner_positions_[i]), ab = to_double(corner_positions_[i + 1]) - a,
                             ac = to_double(corner_positions_[i + 2]) - a, area = cross(ab, ac);
            const Vec3 normal = unit_or_up(to_float(area / std::sqrt(dot(area, area))));
            normals_[i] = normals_[i + 1] = normals_[i + 2] = normal;
        }
        return {.positions = corner_positions_, .normals = normals_, .uv = corner_uv_, .indices = corner_numbers_};
    }

private:
    template <class T>
    std::vector<T> expanded(std::span<const T> of_vertices) const {
        std::vector<T> of_corners(indices_.size());
        for (std::size_t i = 0; i < of_corners.size(); ++i) of_corners[i] = of_vertices[indices_[i]];
        return of_corners;
    }
    static Vec3 unit_or_up(Vec3 v) {
        const Vec3 unit = normalize_safely(v);
        return is_finite(unit) ? unit : Vec3{0, 0, 1};
    }

    bool has_normals_;
    std::span<const uint32_t> indices_;
    std::span<const Vec2> uv_;
    std::vector<uint32_t> corner_numbers_;
    std::vector<Vec2> corner_uv_;
    std::vector<Vec3> corner_positions_, normals_;
};

template <class T>
void append_copies(std::vector<T>& values, const std::vector<uint32_t>& copied_from) {
    if (values.empty()) return;
    values.reserve(values.size() + copied_from.size());
    for (const uint32_t i : copied_from) values.push_back(values[i]);
}

template <class T>
void append_copies(std::vector<T>& values, const std::vector<uint32_t>& copied_from, uint32_t values_each) {
    values.reserve(values.size() + copied_from.size() * values_each);
    for (const uint32_t i : copied_from) {
        for (uint32_t k = 0; k < values_each; ++k) values.push_back(values[i * std::size_t(values_each) + k]);
    }
}

std::vector<Vec4> at_vertices(const std::vector<Vec4>& of_corners, const SplitVertices& split) {
    std::vector<Vec4> tangents;
    tangents.reserve(split.first_corner.size());
    for (const uint32_t corner : split.first_corner) {
        tangents.push_back(corner == kNoCornerShows ? Vec4{1, 0, 0, 1} : of_corners[corner]);
    }
    return tangents;
}

std::vector<Vec3> sum(const std::vector<Vec3>& values, const std::vector<Vec3>& offsets) {
    std::vector<Vec3> sums = values;
    for (std::size_t i = 0; i < offsets.size(); ++i) sums[i] += offsets[i];
    return sums;
}

/// Returns the differences between the tangents of the mesh at a target and those at rest; empty if there are none.
std::vector<Vec3> tangent_offsets(const std::vector<Vec4>& at_target, const std::vector<Vec4>& tangents) {
    std::vector<Vec3> offsets;
    offsets.reserve(tangents.size());
    bool any = false;
    for (std::size_t i = 0; i < tangents.size(); ++i) {
        const Vec4 to = at_target[i], from = tangents[i];
        offsets.push_back({to.x - from.x, to.y - from.y, to.z - from.z});
        any |= !(offsets.back() == Vec3());
    }
    return any ? offsets : std::vector<Vec3>();
}

void wind_other_way(std::vector<uint32_t>& indices) {
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) std::swap(indices[i + 1], indices[i + 2]);
}

/// Adds tangents to a mesh. `shape` is null if nothing moves the vertices; otherwise the caller makes the mesh's
/// vertices from the shape's.
void add_tangents(Mesh& mesh, MeshShape* shape, uint8_t uv_set) {
    const bool is_turned_over = shape != nullptr && shape->is_turned_over;
    if (is_turned_over) wind_other_way(mesh.indices);
    const std::vector<Vec3>& positions = shape != nullptr ? shape->positions : mesh.positions;
    const std::vector<Vec3>& normals = shape != nullptr ? shape->normals : mesh.normals;
    Vertices vertices(mesh.indices, mesh.uv[uv_set], !normals.empty());
    const TangentMesh at_rest = vertices.at(positions, normals);
    const TangentGroups groups = make_tangent_groups(at_rest);
    const std::vector<Vec4> of_corners = corner_tangents(at_rest, groups);
    const SplitVertices split = split_vertices(mesh.indices, mesh.positions.size(), of_corners);
    mesh.tangents = at_vertices(of_corners, split);
    if (shape != nullptr) {
        shape->tangents = mesh.tangents;
        for (MorphTarget& target : shape->targets) {
            target.tangents.clear();
            if (target.positions.empty() && target.normals.empty()) continue;
            const std::vector<Vec3> moved_positions = sum(positions, target.positions);
            const TangentMesh moved = vertices.at(moved_positions, sum(normals, target.normals));
            target.tangents = tangent_offsets(at_vertices(corner_tangents(moved, groups), split), mesh.tangents);
        }
    }
    mesh.indices = split.indices;
    if (is_turned_over) wind_other_way(mesh.indices);
    const std::vector<uint32_t>& copied_from = split.copied_from;
    append_copies(mesh.positions, copied_from);
    append_copies(mesh.normals, copied_from);
    for (std::vector<Vec2>& uv : mesh.uv) append_copies(uv, copied_from);
    append_copies(mesh.colors, copied_from);
    if (shape == nullptr) return;
    append_copies(shape->positions, copied_from);
    append_copies(shape->normals, copied_from);
    for (MorphTarget& target : shape->targets) {
        append_copies(target.positions, copied_from);
        append_copies(target.normals, copied_from);
    }
    append_copies(shape->joints, copied_from, shape->joints_per_vertex);
    append_copies(shape->weights, copied_from, shape->joints_per_vertex);
}

constexpr uint32_t kNone = 0xffffffffu;

/// The meshes that replace an instance's mesh, by the set of coordinates that its normal map uses; kNone if there is
/// none.
using MeshBySet = std::array<uint32_t, kTextureSets>;

/// Returns whether only the anisotropy of its reflection or its coat needs tangents, with or without a texture.
bool is_stretched(const MaterialParameters& material) {
    return (material.has_anisotropy() || material.has_coat_anisotropy()) && !material.normal_texture.has_image();
}

/// Returns the texture that selects the set of coordinates for tangents; of several the base's.
const TextureRef& tangent_map(const MaterialParameters& material) {
    if (material.normal_texture.has_image()) return material.normal_texture;
    if (material.has_coat() && material.coat_normal_texture.has_image()) return material.coat_normal_texture;
    const bool is_of_coat = material.has_coat_anisotropy() && !material.has_anisotropy();
    return is_of_coat ? material.coat_anisotropy_texture : material.anisotropy_texture;
}

/// Returns the scene's materials with all coats and anisotropies that animations may give them.
std::vector<MaterialParameters> materials_in_motion(const Scene& scene) {
    std::vector<MaterialParameters> materials(scene.materials.begin(), scene.materials.end());
    for (const Animation& animation : scene.animations) {
        for (const AnimationChannel& channel : animation.channels) {
            if (channel.part != AnimatedPart::MaterialNumbers) continue;
            const auto changes = [&](const char* name) { return channel.numbers == material_numbers(name); };
            if (changes("coat_weight")) materials[channel.target].coat_weight = 1;
            if (changes("specular_roughness_anisotropy")) materials[channel.target].specular_roughness_anisotropy = 1;
        }
    }
    return materials;
}

/// Adds copies of meshes that need tangents for several sets, and redirects instances to theirs.
std::vector<MeshBySet> choose_meshes(Scene& scene) {
    MeshBySet none;
    none.fill(kNone);
    std::vector<MeshBySet> chosen(scene.meshes.size(), none);
    const std::vector<MaterialParameters> materials = materials_in_motion(scene);
    for (Instance& instance : scene.instances) {
        const MaterialParameters& material = materials[instance.material];
        const TextureRef& map = tangent_map(material);
        const Mesh& mesh = scene.meshes[instance.mesh];
        if (!(map.has_image() || is_stretched(material)) || !mesh.tangents.empty() || mesh.uv[map.uv_set].empty())
            continue;
        MeshBySet& by_set = chosen[instance.mesh];
        if (by_set[map.uv_set] == kNone) {
            if (by_set == none) {
                by_set[map.uv_set] = instance.mesh;
            } else {
                by_set[map.uv_set] = static_cast<uint32_t>(scene.meshes.size());
                scene.meshes.push_back(Mesh(mesh));
                const auto shape = std::ranges::find(scene.shapes, instance.mesh, &MeshShape::mesh);
                if (shape != scene.shapes.end()) {
                    MeshShape copy = *shape;
                    copy.mesh = by_set[map.uv_set];
                    scene.shapes.push_back(std::move(copy));
                }
            }
        }
        instance.mesh = by_set[map.uv_set];
    }
    return chosen;
}

} // namespace

void make_tangents(Scene& scene, Sink& sink) {
    struct Task {
        uint32_t mesh;
        uint8_t uv_set;
    };
    std::vector<Task> tasks;
    for (const MeshBySet& by_set : choose_meshes(scene)) {
        for (uint8_t set = 0; set < kTextureSets; ++set) {
            if (by_set[set] != kNone) tasks.push_back({by_set[set], set});
        }
    }
    if (tasks.empty()) return;
    std::vector<MeshShape*> shapes(scene.meshes.size());
    for (MeshShape& shape : scene.shapes) shapes[shape.mesh] = &shape;
    parallel_for(tasks.size(), 1, [&](uint64_t i) {
        sink.check();
        add_tangents(scene.meshes[tasks[i].mesh], shapes[tasks[i].mesh], tasks[i].uv_set);
    });
    std::vector<MeshShape*> changed;
    for (const Task& task : tasks) {
        if (shapes[task.mesh] != nullptr) changed.push_back(shapes[task.mesh]);
    }
    shape_at_rest(scene, changed);
}

} // namespace pertev
