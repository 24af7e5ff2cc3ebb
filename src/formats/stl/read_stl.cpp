#include "formats/stl/read_stl.h"

#include <bit>
#include <numeric>

#include <fmt/format.h>

#include "base/key_numbers.h"
#include "base/read_file.h"
#include "formats/mesh/move_positions.h"
#include "formats/mesh/vertex_key.h"
#include "formats/stl/parse_stl.h"
#include "scene/position_bounds.h"

namespace pertev {
namespace {

/// Subtracts the origin in double if the triangles are away from 0. Returns their box in the coordinates of the file.
DoubleBounds3 move_to_origin(StlData& data) {
    Bounds3 sample;
    for (std::size_t i = 0; i < data.corners.size(); i += kCornersApart) sample.extend(data.corners[i]);
    if (surely_stays(sample)) return {};
    std::vector<uint32_t> all(data.corners.size());
    std::iota(all.begin(), all.end(), 0u);
    const auto box = [&] { return bounds_of(data.corners, all); };
    const DoubleBounds3 in_file = double_box_of(box());
    if (origin_for(in_file) == DoubleVec3{0, 0, 0}) return in_file;
    if (data.exact.empty()) {
        for (const Vec3& p : data.corners) data.exact.push_back(to_double(p));
    }
    return move_positions(in_file, data.exact, data.corners, box);
}

/// Returns the mesh of these corners. The two zeros are one position.
Mesh mesh_of(std::span<const Vec3> corners, Sink& sink) {
    Mesh mesh;
    KeyNumbers<VertexKey> table(corners.size());
    mesh.indices.reserve(corners.size());
    const auto bits = [](float x) { return std::bit_cast<uint32_t>(x + 0.0f); };
    for (const Vec3& p : corners) {
        sink.check_at(mesh.indices.size());
        mesh.indices.push_back(table.number_of({bits(p.x), bits(p.y), bits(p.z)}));
    }
    mesh.positions.reserve(table.keys().size());
    for (const VertexKey& key : table.keys()) {
        mesh.positions.push_back(
            {std::bit_cast<float>(key.position), std::bit_cast<float>(key.uv), std::bit_cast<float>(key.normal)});
    }
    return mesh;
}

} // namespace

Scene read_stl(const std::filesystem::path& path, const FileAccess&, const ReadOptions&, Sink& sink) {
    StlData data = parse_stl(read_file(path), path.string(), sink);
    Scene scene;
    set_origin(move_to_origin(data), scene);
    const std::string name = path.stem().string();
    scene.materials.emplace_back().name = name;
    std::span<const Vec3> rest = data.corners;
    for (const StlSolid& solid : data.solids) {
        if (solid.triangles == 0) continue;
        Mesh mesh = mesh_of(rest.first(3 * solid.triangles), sink);
        rest = rest.subspan(3 * solid.triangles);
        mesh.name = solid.name.empty() ? name : solid.name;
        if (solid.line > 0) mesh.origin = fmt::format("line {}", solid.line);
        scene.instances.push_back({.name = mesh.name,
                                   .mesh = static_cast<uint32_t>(scene.meshes.size()),
                                   .material = 0,
                                   .world_from_local = {}});
        scene.meshes.push_back(std::move(mesh));
    }
    if (scene.instances.empty()) scene.no_instances = "the file has no triangle";
    return scene;
}

} // namespace pertev
