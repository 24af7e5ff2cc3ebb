#include "formats/gltf/primitive.h"

#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "formats/gltf/triangle_list.h"

namespace pertev::gltf {
namespace {

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

class AttributeReader {
public:
    AttributeReader(const PrimitiveRequest& request, const JsonValue& attributes)
        : request_(request), attributes_(attributes) {}

    /// The accessor of an attribute, with as many elements as there are vertices (0: any number).
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

void read_attributes(const PrimitiveRequest& request, const JsonValue& attributes, Mesh& mesh) {
    const AttributeReader reader(request, attributes);
    const auto positions = reader.find("POSITION", 0, {ElementType::Vec3});
    const uint64_t vertices = positions->count();
    if (vertices > std::numeric_limits<uint32_t>::max()) {
        throw attributes.at("POSITION").error("more vertices than a 32-bit index can number");
    }
    mesh.positions = positions->read_vec3();
    if (vertices == 0) return;
    if (const auto normals = reader.find("NORMAL", vertices, {ElementType::Vec3})) mesh.normals = normals->read_vec3();
    if (request.geometry_only) return;
    const auto tangents = reader.find("TANGENT", vertices, {ElementType::Vec4});
    if (tangents && !mesh.normals.empty()) mesh.tangents = tangents->read_vec4(); // without normals they mean nothing
    if (const auto uv = reader.find("TEXCOORD_0", vertices, {ElementType::Vec2})) mesh.uv[0] = uv->read_vec2();
    if (const auto uv = reader.find("TEXCOORD_1", vertices, {ElementType::Vec2})) mesh.uv[1] = uv->read_vec2();
    if (const auto colors = reader.find("COLOR_0", vertices, {ElementType::Vec3, ElementType::Vec4})) {
        mesh.colors = read_colors(*colors);
    }
}

std::vector<MorphTarget> read_targets(const PrimitiveRequest& request, const Mesh& mesh) {
    std::vector<MorphTarget> targets;
    for (const JsonValue& source : request.primitive.elements_of("targets")) {
        const AttributeReader reader(request, source);
        const auto read = [&](std::string_view name, std::size_t vertices) {
            const auto offsets = vertices == 0 ? std::nullopt : reader.find(name, vertices, {ElementType::Vec3});
            return offsets ? offsets->read_vec3() : std::vector<Vec3>();
        };
        MorphTarget& target = targets.emplace_back();
        target.positions = read("POSITION", mesh.positions.size());
        target.normals = read("NORMAL", mesh.normals.size());
        target.tangents = read("TANGENT", mesh.tangents.size());
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
    std::vector<uint32_t> corners = accessor.read_integers();
    for (std::size_t i = 0; i < corners.size(); ++i) {
        if (corners[i] >= vertices) {
            throw reference->error(
                fmt::format("index {} is {}; expected less than {}, the number of vertices", i, corners[i], vertices));
        }
    }
    return corners;
}

} // namespace

std::optional<Primitive> read_primitive(const PrimitiveRequest& request, Messages& messages) {
    const std::string& file = request.document.file();
    const Topology topology = read_topology(request.primitive);
    if (!draws_triangles(topology)) {
        messages.warn(fmt::format("{}: a part made of points or lines is left out", file));
        return std::nullopt;
    }
    const JsonValue attributes = request.primitive.at("attributes");
    if (!attributes.find("POSITION")) {
        messages.warn(fmt::format("{}: a part without positions is left out", file));
        return std::nullopt;
    }
    Primitive result;
    Mesh& mesh = result.mesh;
    read_attributes(request, attributes, mesh);
    result.targets = read_targets(request, mesh);
    std::vector<uint32_t> corners = read_corners(request, mesh.positions.size());
    if (topology == Topology::Triangles && corners.size() % 3 != 0) {
        messages.warn(
            fmt::format("{}: a list of triangles whose length is not a multiple of 3; the rest is left out", file));
    }
    if (topology != Topology::Triangles)
        request.buffers.charge(corners.size() * 3 * sizeof(uint32_t), request.primitive);
    mesh.indices = triangle_list(topology, std::move(corners));
    if (mesh.indices.empty()) {
        messages.warn(fmt::format("{}: a part without a whole triangle is left out", file));
        return std::nullopt;
    }
    return result;
}

} // namespace pertev::gltf
