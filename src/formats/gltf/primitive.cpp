#include "formats/gltf/primitive.h"

#include <algorithm>
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

// Adds weight * delta to each of `values`; Vec4 (tangents) keeps its w.
template <class Vector>
void add_deltas(const AttributeReader& target, std::string_view name, float weight, std::vector<Vector>& values) {
    if (values.empty()) return;
    const auto deltas = target.find(name, values.size(), {ElementType::Vec3});
    if (!deltas) return;
    const std::vector<Vec3> offsets = deltas->read_vec3();
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i].x += weight * offsets[i].x;
        values[i].y += weight * offsets[i].y;
        values[i].z += weight * offsets[i].z;
    }
}

void apply_morph_targets(const PrimitiveRequest& request, Mesh& mesh) {
    const std::vector<JsonValue> targets = request.primitive.elements_of("targets");
    for (std::size_t i = 0; i < std::min(targets.size(), request.morph_weights.size()); ++i) {
        const float weight = request.morph_weights[i];
        if (weight == 0) continue;
        const AttributeReader target(request, targets[i]);
        add_deltas(target, "POSITION", weight, mesh.positions);
        add_deltas(target, "NORMAL", weight, mesh.normals);
        add_deltas(target, "TANGENT", weight, mesh.tangents);
    }
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

std::optional<Mesh> read_primitive(const PrimitiveRequest& request, Messages& messages) {
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
    Mesh mesh;
    read_attributes(request, attributes, mesh);
    apply_morph_targets(request, mesh);
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
    return mesh;
}

} // namespace pertev::gltf
