#include "formats/gltf/primitive.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "formats/gltf/draco.h"
#include "formats/gltf/extensions.h"
#include "formats/gltf/leave_out.h"

namespace pertev::gltf {
namespace {

enum class Topology : uint8_t { Points, Lines, LineLoop, LineStrip, Triangles, TriangleStrip, TriangleFan };

Topology read_topology(const JsonValue& primitive) {
    const uint64_t mode = primitive.unsigned_or("mode", static_cast<uint64_t>(Topology::Triangles));
    if (mode > static_cast<uint64_t>(Topology::TriangleFan)) {
        throw primitive.at("mode").error(fmt::format("{}; expected 0 to 6", mode));
    }
    return static_cast<Topology>(mode);
}

bool draws_triangles(Topology topology) {
    return topology == Topology::Triangles || topology == Topology::TriangleStrip || topology == Topology::TriangleFan;
}

/// Three indices per triangle, counter-clockwise as seen from the front, from the corners in the order of the file.
/// Corners that form no complete triangle are ignored. Only for the three triangle topologies. Source: glTF 2.0
/// section 3.7.2.1.
std::vector<uint32_t> triangle_list(Topology topology, std::vector<uint32_t> corners) {
    if (topology == Topology::Triangles) {
        corners.resize(corners.size() / 3 * 3);
        return corners;
    }
    PERTEV_CHECK(topology == Topology::TriangleStrip || topology == Topology::TriangleFan);
    std::vector<uint32_t> triangles;
    if (corners.size() < 3) return triangles;
    triangles.reserve((corners.size() - 2) * 3);
    for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
        if (topology == Topology::TriangleStrip) { // every other triangle of a strip runs the other way round
            const std::size_t odd = i % 2;
            triangles.insert(triangles.end(), {corners[i], corners[i + 1 + odd], corners[i + 2 - odd]});
        } else {
            triangles.insert(triangles.end(), {corners[i + 1], corners[i + 2], corners[0]});
        }
    }
    return triangles;
}

class AttributeReader {
public:
    AttributeReader(const PrimitiveRequest& request, const JsonValue& attributes)
        : request_(request), attributes_(attributes) {}

    /// Returns the accessor of an attribute with one element per vertex; `vertices` may be 0 for any number.
    std::optional<Accessor> find(std::string_view name, uint64_t vertices,
                                 std::initializer_list<ElementType> types) const {
        const std::optional<JsonValue> reference = attributes_.find(name);
        if (!reference) return std::nullopt;
        std::optional<Accessor> accessor(std::in_place, request_.document, request_.buffers, *reference, types);
        if (vertices != 0 && accessor->count() != vertices) {
            throw reference->error(
                fmt::format("{} elements; expected {}, one for each of POSITION", accessor->count(), vertices));
        }
        if (accessor->component_type() == ComponentType::UInt32) {
            throw reference->error("the accessor's component type is 5125; expected a float or an 8 or 16-bit integer");
        }
        return accessor;
    }

private:
    const PrimitiveRequest& request_;
    const JsonValue& attributes_;
};

std::vector<Vec4> read_colors(const Accessor& accessor) {
    if (accessor.element_type() == ElementType::Vec4) return accessor.read_vec4();
    std::vector<Vec4> colors;
    colors.reserve(accessor.count());
    for (const Vec3 rgb : accessor.read_vec3()) colors.push_back({rgb.x, rgb.y, rgb.z, 1});
    return colors;
}

void read_attributes(const PrimitiveRequest& request, const JsonValue& attributes, Mesh& mesh, Sink& sink) {
    const AttributeReader reader(request, attributes);
    const auto positions = reader.find("POSITION", 0, {ElementType::Vec3});
    const uint64_t vertices = positions->count();
    if (vertices > std::numeric_limits<uint32_t>::max()) {
        throw attributes.at("POSITION").error("more vertices than a 32-bit index can number");
    }
    mesh.positions = positions->read_vec3();
    if (vertices == 0) return;
    // The shape is there without these.
    const auto attempt = [&](const std::string& name, std::initializer_list<ElementType> types, const auto& take) {
        read_or_leave_out(fmt::format("{}/{}", attributes.pointer(), name), sink, [&] {
            if (const auto accessor = reader.find(name, vertices, types)) take(*accessor);
        });
    };
    attempt("NORMAL", {ElementType::Vec3}, [&](const Accessor& normals) { mesh.normals = normals.read_vec3(); });
    if (request.geometry_only) return;
    attempt("TANGENT", {ElementType::Vec4}, [&](const Accessor& tangents) {
        if (!mesh.normals.empty()) mesh.tangents = tangents.read_vec4(); // without normals they mean nothing
    });
    for (std::size_t i = 0; i < request.sets.size(); ++i) {
        attempt(fmt::format("TEXCOORD_{}", request.sets[i]), {ElementType::Vec2},
                [&](const Accessor& uv) { mesh.uv[i] = uv.read_vec2(); });
    }
    attempt("COLOR_0", {ElementType::Vec3, ElementType::Vec4},
            [&](const Accessor& colors) { mesh.colors = read_colors(colors); });
}

std::vector<MorphTarget> read_targets(const PrimitiveRequest& request, const Mesh& mesh, Sink& sink) {
    std::vector<MorphTarget> targets;
    for (const JsonValue& source : request.primitive.elements_of("targets")) {
        const AttributeReader reader(request, source);
        const auto read = [&](std::string_view name, std::size_t vertices) {
            const auto offsets = vertices == 0 ? std::nullopt : reader.find(name, vertices, {ElementType::Vec3});
            return offsets ? offsets->read_vec3() : std::vector<Vec3>();
        };
        MorphTarget& target = targets.emplace_back();
        read_or_leave_out(source, sink, [&] {
            target.positions = read("POSITION", mesh.positions.size());
            target.normals = read("NORMAL", mesh.normals.size());
            target.tangents = read("TANGENT", mesh.tangents.size());
        });
    }
    return targets;
}

std::vector<uint32_t> read_corners(const PrimitiveRequest& request, std::size_t vertices) {
    const std::optional<JsonValue> reference = request.primitive.find("indices");
    if (!reference) {
        request.buffers.charge(vertices * sizeof(uint32_t), request.primitive);
        std::vector<uint32_t> corners(vertices);
        std::iota(corners.begin(), corners.end(), 0u);
        return corners;
    }
    const Accessor accessor(request.document, request.buffers, *reference, {ElementType::Scalar});
    return accessor.read_integers();
}

/// Leaves out triangles with a corner whose index is out of range.
void drop_triangles_past(std::size_t vertices, const JsonValue& primitive, std::vector<uint32_t>& indices, Sink& sink) {
    const auto is_past = [&](uint32_t index) { return index >= vertices; };
    const auto first = std::ranges::find_if(indices, is_past);
    if (first == indices.end()) return;
    const uint32_t index = *first;
    std::size_t kept = 0;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        if (is_past(indices[i]) || is_past(indices[i + 1]) || is_past(indices[i + 2])) continue;
        for (std::size_t c = 0; c < 3; ++c) indices[kept++] = indices[i + c];
    }
    const std::size_t dropped = (indices.size() - kept) / 3;
    indices.resize(kept);
    sink.leave_out({primitive.at("indices").location(),
                    fmt::format("index {} exceeds the {} vertices; {} with such a corner left out", index, vertices,
                                dropped == 1 ? "the triangle" : fmt::format("the {} triangles", dropped))});
}

/// Returns whether the vertices exist only in a Draco stream.
bool is_compressed_alone(const PrimitiveRequest& request, const JsonValue& position) {
    if (!request.primitive.extension("KHR_draco_mesh_compression")) return false;
    const JsonValue& accessor = request.document.item("accessors", position);
    return !accessor.find("bufferView") && !accessor.find("sparse");
}

} // namespace

std::optional<Primitive> read_primitive(const PrimitiveRequest& request, Sink& sink) {
    const auto leave_out = [&](const std::string& what) {
        sink.leave_out({request.primitive.location(), what});
        return std::nullopt;
    };
    const Topology topology = read_topology(request.primitive);
    if (!draws_triangles(topology)) return leave_out("a primitive of points or lines is left out");
    const JsonValue attributes = request.primitive.at("attributes");
    const std::optional<JsonValue> position = attributes.find("POSITION");
    if (!position) return leave_out("a primitive without positions is left out");
    const bool is_compressed = is_compressed_alone(request, *position);
    if (is_compressed && has_draco()) decode_draco(request.document, request.buffers, request.primitive);
    if (is_compressed && !has_draco()) {
        constexpr std::string_view draco = "KHR_draco_mesh_compression";
        return leave_out(
            fmt::format("a primitive compressed by {}, which this program was built without, is left out{}", draco,
                        conversion_advice(draco, request.document.path())));
    }
    Primitive result;
    Mesh& mesh = result.mesh;
    read_attributes(request, attributes, mesh, sink);
    result.targets = read_targets(request, mesh, sink);
    std::vector<uint32_t> corners = read_corners(request, mesh.positions.size());
    if (topology == Topology::Triangles && corners.size() % 3 != 0) {
        leave_out("the number of corners of triangles is not a multiple of 3; the rest is left out");
    }
    if (topology != Topology::Triangles)
        request.buffers.charge(corners.size() * 3 * sizeof(uint32_t), request.primitive);
    mesh.indices = triangle_list(topology, std::move(corners));
    drop_triangles_past(mesh.positions.size(), request.primitive, mesh.indices, sink);
    if (mesh.indices.empty()) return leave_out("a primitive without a complete triangle is left out");
    return result;
}

} // namespace pertev::gltf
