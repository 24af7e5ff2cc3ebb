#include "formats/mitsuba/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/message_text.h"
#include "base/read_file.h"
#include "formats/described/finish_meshes.h"
#include "formats/described/transforms.h"
#include "formats/files/closest_name.h"
#include "formats/mesh/smooth_normals.h"
#include "formats/mitsuba/read_serialized.h"
#include "formats/obj/read_obj.h"
#include "formats/ply/read_ply.h"
#include "formats/shapes/quadrics.h"
#include "image/srgb.h"

namespace pertev::mitsuba {
namespace {

constexpr std::array<std::string_view, 10> kShapeTypes = {"obj",  "ply",      "serialized", "rectangle", "cube",
                                                          "disk", "cylinder", "shapegroup", "instance",  "sphere"};
constexpr std::array<std::string_view, 12> kOtherShapeTypes = {
    "hair",           "bsplinecurve", "linearcurve", "sdfgrid",    "blender",      "ellipsoids",
    "ellipsoidsmesh", "heightfield",  "merge",       "deformable", "hair_strands", "mesh"};

/// Joins the meshes of a file, whose groups are one shape for Mitsuba.
Mesh joined(std::vector<Mesh> meshes) {
    if (meshes.size() == 1) return std::move(meshes.front());
    Mesh all;
    bool has_normals = true, has_uv = false;
    for (const Mesh& mesh : meshes) {
        has_normals = has_normals && (mesh.positions.empty() || !mesh.normals.empty());
        has_uv = has_uv || !mesh.uv[0].empty();
    }
    for (const Mesh& mesh : meshes) {
        const auto first = static_cast<uint32_t>(all.positions.size());
        all.positions.insert(all.positions.end(), mesh.positions.begin(), mesh.positions.end());
        if (has_normals) all.normals.insert(all.normals.end(), mesh.normals.begin(), mesh.normals.end());
        if (has_uv) {
            all.uv[0].insert(all.uv[0].end(), mesh.uv[0].begin(), mesh.uv[0].end());
            all.uv[0].resize(all.positions.size());
        }
        for (const uint32_t i : mesh.indices) all.indices.push_back(first + i);
    }
    return all;
}

/// Returns the frame whose +z leads from `from` to `to`, with the other axes that Mitsuba chooses.
/// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 6(1), 2017.
DoubleTransform frame_between(DoubleVec3 from, DoubleVec3 to) {
    const DoubleVec3 along = to - from, z = along / std::sqrt(dot(along, along));
    const double sign = std::copysign(1.0, z.z), a = -1 / (sign + z.z), b = z.x * z.y * a;
    const DoubleVec3 x = {1 + sign * z.x * z.x * a, sign * b, -sign * z.x}, y = {b, sign + z.y * z.y * a, -z.y};
    return {{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}, from};
}

} // namespace

Mesh make_rectangle() {
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.normals.assign(4, {0, 0, 1});
    mesh.uv[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

Mesh make_cube() {
    // The corners of each face have the coordinates (0, 1), (1, 1), (1, 0) and (0, 0).
    struct Face {
        Vec3 normal, corners[4];
    };
    constexpr Face kFaces[] = {{{0, -1, 0}, {{1, -1, -1}, {1, -1, 1}, {-1, -1, 1}, {-1, -1, -1}}},
                               {{0, 1, 0}, {{1, 1, -1}, {-1, 1, -1}, {-1, 1, 1}, {1, 1, 1}}},
                               {{1, 0, 0}, {{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}}},
                               {{0, 0, 1}, {{1, -1, 1}, {1, 1, 1}, {-1, 1, 1}, {-1, -1, 1}}},
                               {{-1, 0, 0}, {{-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1}, {-1, -1, -1}}},
                               {{0, 0, -1}, {{1, 1, -1}, {1, -1, -1}, {-1, -1, -1}, {-1, 1, -1}}}};
    Mesh mesh;
    for (const Face& face : kFaces) {
        const auto first = static_cast<uint32_t>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), std::begin(face.corners), std::end(face.corners));
        mesh.normals.insert(mesh.normals.end(), 4, face.normal);
        mesh.uv[0].insert(mesh.uv[0].end(), {{0, 1}, {1, 1}, {1, 0}, {0, 0}});
        for (const uint32_t i : {0u, 1u, 2u, 3u, 0u, 2u}) mesh.indices.push_back(first + i);
    }
    return mesh;
}

uint32_t Shapes::add(const std::string& key, const Object& shape, bool is_reversed, Mesh mesh) {
    const auto [known, is_new] = shared_.try_emplace(
        fmt::format("{} {} {} {} {}", is_reversed, needs_.tangents, needs_.mirrors, needs_.colors, key),
        static_cast<uint32_t>(reading_.parts.meshes.size()));
    if (!is_new) return known->second;
    if (needs_.tangents) with_tangents_[known->second] = needs_.mirrors;
    ShapeMesh made;
    made.mesh = std::move(mesh);
    made.location = shape.location();
    made.is_reversed = is_reversed;
    reading_.parts.meshes.push_back(std::move(made));
    return known->second;
}

uint32_t Shapes::file_mesh(Object& shape, bool is_reversed, const DoubleTransform& to_world) {
    Parameters& parameters = shape.parameters;
    Sink& sink = reading_.sink();
    const std::string name = parameters.text("filename", "", sink);
    if (name.empty()) throw parameters.error(fmt::format("{} has no filename", parameters.what()));
    const auto path = find_file(reading_.context, shape.location(), name);
    if (!path) throw parameters.error(fmt::format("there is no file {}", shortened(name)));
    FileUse use;
    use.kind = shape.type[0];
    // Readers of OBJ and PLY turn v, which points up there; only Mitsuba's PLY and serialized files have it downwards.
    const bool is_turned = parameters.truth("flip_tex_coords", use.kind == 'o', sink);
    use.flips_v = use.kind == 's' ? is_turned : !is_turned;
    use.has_face_normals = parameters.truth("face_normals", false, sink);
    use.is_mirrored = determinant(to_world) < 0;
    use.has_colors = needs_.colors;
    if (use.kind == 's')
        use.index =
            static_cast<uint32_t>(std::clamp<int64_t>(parameters.integer("shape_index", 0, sink), 0, UINT32_MAX));
    parameters.ignore({"srgb", "collapse", "max_smooth_angle"});
    const std::string key = fmt::format("{} {} {} {} {} {}", use.kind, use.flips_v, use.has_face_normals,
                                        use.is_mirrored, use.index, path->string());
    const uint32_t mesh = add(key, shape, is_reversed, {});
    reading_.parts.meshes[mesh].file = path->string();
    files_[mesh] = use;
    return mesh;
}

std::optional<ReadShape> Shapes::read(Object& shape, MeshNeeds needs) {
    needs_ = needs;
    Parameters& parameters = shape.parameters;
    Sink& sink = reading_.sink();
    const DoubleTransform to_world = transform_of(shape, "to_world", sink);
    needs_.mirrors = needs.tangents && (determinant(to_world) < 0) != needs.mirrors;
    const bool is_reversed = parameters.truth("flip_normals", false, sink);
    const std::string& type = shape.type;
    if (type == "obj" || type == "ply" || type == "serialized")
        return ReadShape{file_mesh(shape, is_reversed, to_world), to_world};
    if (type == "rectangle") return ReadShape{add(type, shape, is_reversed, make_rectangle()), to_world};
    if (type == "cube") return ReadShape{add(type, shape, is_reversed, make_cube()), to_world};
    if (type == "sphere") {
        const double radius = parameters.number("radius", 1, sink);
        const DoubleVec3 centre = parameters.vector("center", sink).value_or(DoubleVec3{0, 0, 0});
        if (!(radius > 0)) throw parameters.error(fmt::format("the radius is {}; expected above 0", radius));
        return ReadShape{add(type, shape, is_reversed, make_sphere(-1, 1, 2 * kPi)),
                         compose(to_world, compose(translation_by(centre), scale_by({radius, radius, radius})))};
    }
    if (type == "disk") {
        Mesh mesh = make_disk(0, 2 * kPi);
        for (Vec2& uv : mesh.uv[0]) uv = {uv.y, uv.x}; // u is the radius, v the angle
        return ReadShape{add(type, shape, is_reversed, std::move(mesh)), to_world};
    }
    if (type == "cylinder") {
        const DoubleVec3 from = parameters.vector("p0", sink).value_or(DoubleVec3{0, 0, 0}),
                         to = parameters.vector("p1", sink).value_or(DoubleVec3{0, 0, 1});
        const double radius = parameters.number("radius", 1, sink), length = std::sqrt(dot(to - from, to - from));
        if (!(radius > 0 && length > 0)) throw parameters.error("a cylinder has no radius or no length");
        Mesh mesh = make_cylinder(0, 1, 2 * kPi);
        for (Vec2& uv : mesh.uv[0]) uv.y = 1 - uv.y; // v follows the height
        return ReadShape{add(type, shape, is_reversed, std::move(mesh)),
                         compose(to_world, compose(frame_between(from, to), scale_by({radius, radius, length})))};
    }
    const bool is_known = std::ranges::find(kOtherShapeTypes, type) != kOtherShapeTypes.end();
    sink.leave_out({shape.location(), fmt::format("shapes of the type {} are left out{}", shortened(type),
                                                  is_known ? "" : did_you_mean(type, kShapeTypes))});
    return std::nullopt;
}

const std::vector<std::byte>& Shapes::serialized(const std::string& file) {
    const std::lock_guard lock(serialized_mutex_);
    if (const auto known = serialized_.find(file); known != serialized_.end()) return known->second;
    return serialized_.emplace(file, read_file(file)).first->second;
}

void Shapes::read_mesh_file(const FileUse& use, ShapeMesh& to, Sink& sink) {
    bool is_smooth = !use.has_face_normals;
    if (use.kind == 's') {
        SerializedMesh read = read_serialized(serialized(to.file), use.index, to.file);
        is_smooth = is_smooth && !read.has_face_normals;
        to.mesh = std::move(read.mesh);
        to.exact = std::move(read.exact);
    } else {
        ReadOptions options = reading_.context.options;
        options.geometry_only = true; // Mitsuba takes no materials from it
        options.vertex_colors = use.has_colors;
        const FileAccess& access = reading_.context.access;
        Scene scene =
            use.kind == 'o' ? read_obj(to.file, access, options, sink) : read_ply(to.file, access, options, sink);
        if (scene.meshes.empty()) throw Error(ErrorCode::BadInput, FileLocation{to.file}, "the file has no mesh");
        to.mesh = joined(std::move(scene.meshes));
        to.shape_from_mesh = translation_by(scene.origin_in_file);
    }
    Mesh& mesh = to.mesh;
    for (Vec4& c : mesh.colors) c = {srgb_encode(c.x), srgb_encode(c.y), srgb_encode(c.z), 1}; // the file's numbers
    if (use.has_colors && mesh.colors.empty())
        sink.leave_out({to.location, "the mesh has no vertex_color; its surface has the factor alone"});
    if (!mesh.uv[0].empty() && use.flips_v) {
        for (Vec2& uv : mesh.uv[0]) uv.y = 1 - uv.y;
    }
    const bool has_normals = !mesh.normals.empty() && is_smooth;
    if (use.is_mirrored && !has_normals) to.is_reversed = !to.is_reversed;
    if (!is_smooth) mesh.normals.clear();
    const bool fits = std::ranges::none_of(mesh.indices, [&](uint32_t i) { return i >= mesh.positions.size(); });
    if (is_smooth && mesh.normals.empty() && fits) mesh.normals = angle_weighted_normals(mesh);
}

void set_tangents(Mesh& mesh, bool mirrors) {
    if (mesh.uv[0].empty() || !mesh.tangents.empty()) return;
    std::vector<Vec3> sums(mesh.positions.size());
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const uint32_t* const corner = mesh.indices.data() + i;
        const auto edge = [&](int k) { return mesh.positions[corner[k]] - mesh.positions[corner[0]]; };
        const auto change = [&](int k) { return mesh.uv[0][corner[k]] - mesh.uv[0][corner[0]]; };
        const Vec2 b = change(1), c = change(2);
        const float area = b.x * c.y - b.y * c.x;
        if (area == 0) continue;
        const Vec3 along_u = normalize((c.y * edge(1) - b.y * edge(2)) / area);
        if (!is_finite(along_u)) continue;
        for (int k = 0; k < 3; ++k) sums[corner[k]] += along_u;
    }
    const float side = mirrors ? -1.0f : 1.0f;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        Vec3 t = sums[i];
        if (!mesh.normals.empty()) t = t - dot(t, mesh.normals[i]) * mesh.normals[i];
        t = normalize(t);
        mesh.tangents.push_back(is_finite(t) ? Vec4{t.x, t.y, t.z, side} : Vec4{1, 0, 0, side});
    }
}

void Shapes::finish() {
    const ShapeMesh* const first = reading_.parts.meshes.data();
    finish_meshes(
        reading_.parts.meshes,
        [this, first](ShapeMesh& shape, Sink& sink) {
            read_mesh_file(files_.at(static_cast<uint32_t>(&shape - first)), shape, sink);
        },
        reading_.sink());
    serialized_.clear();
    for (const auto& [mesh, mirrors] : with_tangents_) set_tangents(reading_.parts.meshes[mesh].mesh, mirrors);
}

} // namespace pertev::mitsuba
