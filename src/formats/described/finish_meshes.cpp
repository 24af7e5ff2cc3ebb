#include "formats/described/finish_meshes.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/parallel_for.h"
#include "formats/described/transforms.h"
#include "formats/mesh/move_positions.h"
#include "scene/position_bounds.h"

namespace pertev::described {
namespace {

/// Turns triangles whose vertex normals point behind them, and all of a reversed mesh, with its normals.
void wind(ShapeMesh& shape) {
    Mesh& mesh = shape.mesh;
    const bool is_reversed = shape.is_reversed;
    shape.is_turned.assign(mesh.indices.size() / 3, false);
    if (is_reversed) {
        for (Vec3& normal : mesh.normals) normal = -normal;
    }
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        uint32_t* const corner = mesh.indices.data() + i;
        bool turns = is_reversed;
        if (!mesh.normals.empty()) {
            const Vec3 a = mesh.positions[corner[0]];
            const Vec3 across = cross(mesh.positions[corner[1]] - a, mesh.positions[corner[2]] - a);
            const Vec3 sum = mesh.normals[corner[0]] + mesh.normals[corner[1]] + mesh.normals[corner[2]];
            const float side = dot(across, sum);
            if (side != 0) turns = side < 0;
        }
        if (!turns) continue;
        std::swap(corner[1], corner[2]);
        shape.is_turned[i / 3] = true;
    }
}

/// Moves a mesh's positions to their middle in double if they are far from 0.
void subtract_middle(ShapeMesh& shape) {
    Mesh& mesh = shape.mesh;
    if (shape.exact.empty()) return;
    const auto bounds = [&] { return bounds_of(mesh.positions, mesh.indices); };
    DoubleBounds3 box = double_box_of(bounds());
    if (!box.is_empty() && !(origin_for(box) == DoubleVec3{0, 0, 0})) {
        box = move_positions(box, shape.exact, mesh.positions, bounds);
        shape.shape_from_mesh = compose(shape.shape_from_mesh, translation_by(origin_for(box)));
    }
    shape.exact = {};
}

bool reaches_beyond(const Mesh& mesh) {
    return std::ranges::any_of(mesh.indices, [&](uint32_t i) { return i >= mesh.positions.size(); });
}

} // namespace

void finish_meshes(std::vector<ShapeMesh>& meshes, const ReadMeshFile& read, Sink& sink) {
    std::vector<Messages> said(meshes.size());
    parallel_for(meshes.size(), 1, [&](uint64_t i) {
        ShapeMesh& shape = meshes[i];
        if (!shape.file.empty()) {
            PartMessages messages(sink);
            try {
                read(shape, messages);
            } catch (const Error& error) {
                if (error.code() != ErrorCode::BadInput) throw;
                messages.leave_out(error.remark().and_then("; its shape is left out"));
                shape.mesh = {};
            }
            said[i] = std::move(static_cast<Messages&>(messages));
        }
        shape.mesh.origin = fmt::format("{}:{}", shape.location.file, shape.location.line);
        if (reaches_beyond(shape.mesh)) shape.mesh = {};
        subtract_middle(shape);
        wind(shape);
    });
    for (const Messages& messages : said) sink.add_all(messages);
}

Mesh split_faces(const Mesh& mesh) {
    Mesh split;
    split.name = mesh.name;
    split.origin = mesh.origin;
    const auto take = [&](const auto& from, auto& to) {
        if (from.empty()) return;
        to.reserve(mesh.indices.size());
        for (const uint32_t i : mesh.indices) to.push_back(from[i]);
    };
    take(mesh.positions, split.positions);
    take(mesh.normals, split.normals);
    take(mesh.tangents, split.tangents);
    take(mesh.colors, split.colors);
    for (std::size_t set = 0; set < mesh.uv.size(); ++set) take(mesh.uv[set], split.uv[set]);
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) split.indices.push_back(static_cast<uint32_t>(i));
    return split;
}

} // namespace pertev::described
