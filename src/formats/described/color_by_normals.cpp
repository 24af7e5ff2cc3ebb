#include "formats/described/color_by_normals.h"

#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "base/limits.h"
#include "formats/described/finish_meshes.h"
#include "formats/described/transforms.h"

namespace pertev::described {
namespace {

/// Returns the colour of a surface of this normal, which need not be unit.
Vec4 color_of(const NormalMix& mix, DoubleVec3 normal) {
    const double length = std::sqrt(dot(normal, normal));
    const float share = length > 0 ? static_cast<float>(std::abs(dot(normal, mix.direction)) / length) : 0.0f;
    const Rgb color = lerp(mix.second, mix.first, min(share, 1.0f));
    const auto usable = [&](float x) { return clamp(converted(mix.curve, mix.amount, x), 0.0f, 1.0f); };
    return {usable(color.r), usable(color.g), usable(color.b), 1};
}

ShapeMesh colored(const ShapeMesh& from, const NormalMix& mix, const DoubleTransform& world_from_mesh) {
    ShapeMesh shape = from;
    const bool is_smooth = from.is_quadric && !from.mesh.normals.empty();
    if (!is_smooth) shape.mesh = split_faces(from.mesh);
    Mesh& mesh = shape.mesh;
    mesh.colors.clear();
    if (is_smooth) { // normals go by the inverse
        const DoubleTransform back = inverse(world_from_mesh);
        for (const Vec3& local : mesh.normals) {
            const DoubleVec3 n = to_double(local);
            mesh.colors.push_back(color_of(mix, {n.x * back.row0.x + n.y * back.row1.x + n.z * back.row2.x,
                                                 n.x * back.row0.y + n.y * back.row1.y + n.z * back.row2.y,
                                                 n.x * back.row0.z + n.y * back.row1.z + n.z * back.row2.z}));
        }
        return shape;
    }
    for (std::size_t i = 0; i + 2 < mesh.positions.size(); i += 3) {
        const auto corner = [&](std::size_t k) {
            return transform_point(world_from_mesh, to_double(mesh.positions[i + k]));
        };
        const DoubleVec3 a = corner(0);
        mesh.colors.insert(mesh.colors.end(), 3, color_of(mix, cross(corner(1) - a, corner(2) - a)));
    }
    return shape;
}

} // namespace

void color_by_normals(Parts& parts, uint64_t file_bytes, Sink& sink) {
    using Key = std::pair<std::array<double, 9>, std::pair<const NormalMix*, uint32_t>>;
    std::map<Key, uint32_t> known;
    uint64_t left = justified_bytes(kFreeMeshBytes, file_bytes);
    std::map<uint32_t, uint32_t> even; // surfaces of the mean colour
    for (Placed& shape : parts.placed) {
        const auto mix = parts.surfaces[shape.surface].by_normal;
        if (!mix) continue;
        const ShapeMesh& from = parts.meshes[shape.mesh];
        const DoubleTransform m = compose(shape.world_from_mesh, from.shape_from_mesh);
        const Key key = {{m.row0.x, m.row0.y, m.row0.z, m.row1.x, m.row1.y, m.row1.z, m.row2.x, m.row2.y, m.row2.z},
                         {mix.get(), shape.mesh}};
        auto copy = known.find(key);
        if (copy == known.end()) {
            constexpr uint64_t kVertexBytes = 3 * sizeof(Vec4) + sizeof(Vec2) + sizeof(uint32_t);
            const uint64_t bytes = kVertexBytes * from.mesh.indices.size();
            if (bytes > left || !is_finite(m)) {
                sink.leave_out({from.location, "the colour by the direction of a surface is left out; both are mixed "
                                               "evenly"});
                const auto [number, is_new] = even.try_emplace(shape.surface, 0);
                if (is_new) {
                    Surface plain = parts.surfaces[shape.surface];
                    plain.by_normal.reset();
                    plain.material.base_color = mix->mean();
                    number->second = static_cast<uint32_t>(parts.surfaces.size());
                    parts.surfaces.push_back(std::move(plain));
                }
                shape.surface = number->second;
                continue;
            }
            left -= bytes;
            ShapeMesh made = colored(from, *mix, m);
            copy = known.emplace(key, static_cast<uint32_t>(parts.meshes.size())).first;
            parts.meshes.push_back(std::move(made));
        }
        shape.mesh = copy->second;
    }
}

} // namespace pertev::described
