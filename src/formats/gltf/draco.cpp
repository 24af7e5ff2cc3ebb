#include "formats/gltf/draco.h"

#include <cstring>
#include <limits>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "formats/gltf/accessor.h"

#if defined(PERTEV_HAS_DRACO)
#include <draco/compression/decode.h>
#endif

namespace pertev::gltf {

#if defined(PERTEV_HAS_DRACO)

bool has_draco() { return true; }

namespace {

/// Returns the attribute's values of all points, contiguous, as numbers of the accessor's type.
template <class Number>
std::vector<std::byte> values_of(const draco::PointAttribute& attribute, uint32_t points) {
    const auto components = static_cast<std::size_t>(attribute.num_components());
    std::vector<Number> values(components * points);
    for (uint32_t point = 0; point < points; ++point) {
        const draco::AttributeValueIndex index = attribute.mapped_index(draco::PointIndex(point));
        if (index.value() >= attribute.size() || !attribute.ConvertValue<Number>(index, static_cast<int8_t>(components),
                                                                                 values.data() + components * point)) {
            return {};
        }
    }
    std::vector<std::byte> bytes(values.size() * sizeof(Number));
    if (!bytes.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return bytes;
}

std::vector<std::byte> values_of(const draco::PointAttribute& attribute, uint32_t points, uint64_t component_type) {
    switch (static_cast<ComponentType>(component_type)) {
    case ComponentType::Int8:
        return values_of<int8_t>(attribute, points);
    case ComponentType::UInt8:
        return values_of<uint8_t>(attribute, points);
    case ComponentType::Int16:
        return values_of<int16_t>(attribute, points);
    case ComponentType::UInt16:
        return values_of<uint16_t>(attribute, points);
    case ComponentType::UInt32:
        return values_of<uint32_t>(attribute, points);
    case ComponentType::Float:
        return values_of<float>(attribute, points);
    }
    return {};
}

template <class Number>
std::vector<std::byte> corners_of(const draco::Mesh& mesh) {
    std::vector<Number> corners;
    corners.reserve(std::size_t(3) * mesh.num_faces());
    for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
        for (int corner = 0; corner < 3; ++corner)
            corners.push_back(static_cast<Number>(mesh.face(face)[corner].value()));
    }
    std::vector<std::byte> bytes(corners.size() * sizeof(Number));
    if (!bytes.empty()) std::memcpy(bytes.data(), corners.data(), bytes.size());
    return bytes;
}

std::unique_ptr<draco::Mesh> decode_mesh(std::span<const std::byte> bytes, const JsonValue& extension) {
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    draco::Decoder decoder;
    draco::StatusOr<std::unique_ptr<draco::Mesh>> mesh = decoder.DecodeMeshFromBuffer(&buffer);
    if (!mesh.ok())
        throw extension.error(fmt::format("the Draco data is damaged: {}", mesh.status().error_msg_string()));
    return std::move(mesh).value();
}

} // namespace

void decode_draco(const Document& document, Buffers& buffers, const JsonValue& primitive) {
    const JsonValue extension = *primitive.extension("KHR_draco_mesh_compression");
    const std::span<const std::byte> bytes = buffers.view(extension.at("bufferView")).bytes;
    // The counts that the file states bound what is decoded, and count as memory before it is allocated.
    const JsonValue attributes = primitive.at("attributes"), compressed = extension.at("attributes");
    const uint64_t points = document.item("accessors", attributes.at("POSITION")).at("count").to_unsigned();
    buffers.charge(points * 32 + bytes.size(), extension);
    const std::unique_ptr<draco::Mesh> mesh = decode_mesh(bytes, extension);
    if (mesh->num_points() != points) {
        throw extension.error(
            fmt::format("the Draco data has {} vertices; the accessors have {}", mesh->num_points(), points));
    }
    buffers.charge(uint64_t(mesh->num_faces()) * 12, extension);
    for (const auto& [name, id] : compressed.members()) {
        const std::optional<JsonValue> reference = attributes.find(name);
        if (!reference) continue;
        const JsonValue& accessor = document.item("accessors", *reference);
        if (accessor.find("bufferView")) continue;
        const uint64_t unique_id = id.to_unsigned();
        const draco::PointAttribute* attribute = unique_id > std::numeric_limits<uint32_t>::max()
                                                     ? nullptr
                                                     : mesh->GetAttributeByUniqueId(static_cast<uint32_t>(unique_id));
        if (attribute == nullptr) throw id.error(fmt::format("{}; the Draco data has no such attribute", unique_id));
        buffers.put(*reference, values_of(*attribute, mesh->num_points(), accessor.at("componentType").to_unsigned()));
    }
    if (const std::optional<JsonValue> reference = primitive.find("indices")) {
        const JsonValue& accessor = document.item("accessors", *reference);
        if (accessor.find("bufferView")) return;
        const auto type = static_cast<ComponentType>(accessor.at("componentType").to_unsigned());
        buffers.put(*reference, type == ComponentType::UInt8    ? corners_of<uint8_t>(*mesh)
                                : type == ComponentType::UInt16 ? corners_of<uint16_t>(*mesh)
                                                                : corners_of<uint32_t>(*mesh));
    }
}

#else

bool has_draco() { return false; }

void decode_draco(const Document&, Buffers&, const JsonValue& primitive) {
    throw primitive.error("a primitive compressed by Draco, and this program was built without libdraco");
}

#endif

} // namespace pertev::gltf
