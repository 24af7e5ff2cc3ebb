#include "formats/gltf/meshes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/gltf/node_shapes.h"
#include "formats/gltf/skin.h"

namespace pertev::gltf {
namespace {

// Equal texts: equal members.
std::string members_as_text(const JsonValue& object, std::initializer_list<std::string_view> members) {
    std::string text;
    for (const std::string_view member : members) {
        const std::optional<JsonValue> value = object.find(member);
        text += fmt::format("{};", value ? value->to_json() : "");
    }
    return text;
}

// Equal texts: equal vertices and triangles.
std::string data_key(const JsonValue& primitive, const std::vector<float>& weights,
                     const std::optional<JsonValue>& skin) {
    std::string key = members_as_text(primitive, {"mode", "attributes", "indices", "targets"});
    if (primitive.find("targets")) key += fmt::format("{}", fmt::join(weights, ","));
    return key + fmt::format(";{}", skin ? skin->to_json() : "");
}

} // namespace

const std::vector<Meshes::Part>& Meshes::parts_of(const JsonValue& node) {
    const auto [entry, is_new] = by_use_.try_emplace(members_as_text(node, {"mesh", "skin", "weights"}));
    if (is_new) entry->second = read_parts(node);
    return entry->second;
}

std::vector<Meshes::Part> Meshes::read_parts(const JsonValue& node) {
    const JsonValue& mesh = document_.item("meshes", node.at("mesh"));
    const std::vector<float> weights = read_weights(node, mesh);
    const std::optional<JsonValue> skin = node.find("skin");
    const std::string name = mesh.string_or("name", "");
    const std::vector<JsonValue> primitives = mesh.elements_of("primitives");
    std::vector<Part> parts;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        const std::string part_name = primitives.size() > 1 ? fmt::format("{}/{}", name, i) : name;
        const std::optional<uint32_t> index = mesh_of(primitives[i], weights, skin, part_name);
        if (!index) continue;
        parts.push_back({*index, materials_.material_of(primitives[i])});
        check_texture_coordinates(parts.back());
    }
    return parts;
}

void Meshes::check_texture_coordinates(const Part& part) {
    const Mesh& mesh = scene_.meshes[part.mesh];
    const Material& material = scene_.materials[part.material];
    for (const TextureRef* texture : material.textures()) {
        if (!texture->has_image() || !mesh.uv[texture->uv_set].empty()) continue;
        messages_.warn(fmt::format("{}: {}: a texture over TEXCOORD_{}, which a mesh with this material does not have; "
                                   "one point of the texture is shown",
                                   document_.file(), material.origin, texture->uv_set));
    }
}

std::optional<uint32_t> Meshes::mesh_of(const JsonValue& primitive, const std::vector<float>& weights,
                                        const std::optional<JsonValue>& skin, const std::string& name) {
    const auto [entry, is_new] = by_data_.try_emplace(data_key(primitive, weights, skin));
    if (!is_new) return entry->second;
    std::optional<Mesh> mesh = read_primitive({document_, buffers_, primitive, weights, geometry_only_}, messages_);
    if (!mesh) return std::nullopt;
    if (primitive.find("targets")) {
        messages_.warn(fmt::format("{}: morph targets are drawn with their default weights; animation is not played",
                                   document_.file()));
    }
    if (skin) {
        messages_.warn(
            fmt::format("{}: skinned meshes are drawn in their rest pose; animation is not played", document_.file()));
        apply_skin(document_, buffers_, primitive.at("attributes"), joints_of(*skin), *mesh);
    }
    buffers_.charge(name.size(), primitive);
    mesh->name = name;
    mesh->origin = primitive.pointer();
    scene_.meshes.push_back(*std::move(mesh));
    entry->second = static_cast<uint32_t>(scene_.meshes.size() - 1);
    return entry->second;
}

const std::vector<Transform>& Meshes::joints_of(const JsonValue& skin) {
    const uint32_t index = document_.index_into("skins", skin);
    const auto [entry, is_new] = joints_.try_emplace(index);
    if (is_new) entry->second = read_joint_transforms(document_, buffers_, nodes_, document_.table("skins")[index]);
    return entry->second;
}

} // namespace pertev::gltf
