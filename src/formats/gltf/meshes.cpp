#include "formats/gltf/meshes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "formats/gltf/animations.h"
#include "formats/gltf/leave_out.h"
#include "formats/gltf/skin.h"
#include "scene/shape_mesh.h"

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

/// Returns whether a primitive has more than the sets 0 and 1 of texture coordinates.
bool has_further_sets(const JsonValue& primitive) {
    const std::optional<JsonValue> attributes = primitive.find("attributes");
    return attributes && attributes->find("TEXCOORD_2");
}

} // namespace

Meshes::Meshes(const Document& document, Buffers& buffers, const NodeGraph& nodes, Materials& materials, Scene& scene,
               bool geometry_only, Sink& sink)
    : document_(document), buffers_(buffers), nodes_(nodes), materials_(materials), scene_(scene),
      geometry_only_(geometry_only), sink_(sink), reshaped_nodes_(nodes_with_animated_weights(document, scene.clips)) {}

// Equal texts: equal parts at all times.
std::string Meshes::use_key(uint32_t node) const {
    const std::string key = members_as_text(document_.table("nodes")[node], {"mesh", "skin", "weights"});
    return reshaped_nodes_.contains(node) ? fmt::format("{}{}", key, node) : key;
}

// Equal texts: equal vertices and triangles at all times.
std::string Meshes::data_key(const JsonValue& primitive, uint32_t node) const {
    std::string key = members_as_text(primitive, {"mode", "attributes", "indices", "targets"});
    if (primitive.find("targets")) {
        key += fmt::format("{}", fmt::join(scene_.nodes[node].morph_weights, ","));
        if (reshaped_nodes_.contains(node)) key += fmt::format(";{}", node);
    }
    return fmt::format("{};{}", key, scene_.nodes[node].skin);
}

const std::vector<Meshes::Part>& Meshes::parts_of(uint32_t index) {
    const auto [entry, is_new] = by_use_.try_emplace(use_key(index));
    if (is_new) entry->second = read_parts(index);
    return entry->second;
}

std::vector<Meshes::Part> Meshes::read_parts(uint32_t index) {
    const JsonValue& mesh = document_.item("meshes", document_.table("nodes")[index].at("mesh"));
    const std::string name = mesh.string_or("name", "");
    const std::vector<JsonValue> primitives = mesh.elements_of("primitives");
    std::vector<Part> parts;
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        sink_.check();
        const std::string part_name = primitives.size() > 1 ? fmt::format("{}/{}", name, i) : name;
        std::optional<uint32_t> part, material;
        if (has_further_sets(primitives[i]))
            material = material_of(primitives[i]); // the material names the sets to read
        TextureSets sets = material ? sets_of(*material) : TextureSets{0, 1};
        const auto read_mesh = [&] { part = mesh_of(primitives[i], index, part_name, sets); };
        read_or_leave_out(primitives[i], sink_, read_mesh);
        if (!part) continue;
        if (!material) {
            material = material_of(primitives[i]);
            if (sets != sets_of(*material)) {
                sets = sets_of(*material);
                read_mesh();
            }
        }
        parts.push_back({*part, *material});
        check_texture_coordinates(parts.back());
    }
    return parts;
}

/// Returns the sets of texture coordinates of a material, whose textures then have their numbers here.
const TextureSets& Meshes::sets_of(uint32_t index) {
    const auto [entry, is_new] = sets_.try_emplace(index);
    Material& material = scene_.materials[index];
    if (is_new) entry->second = pack_texture_sets(material, document_.file(), material.origin, sink_);
    return entry->second;
}

/// Returns the index of a primitive's material; that of the default material if it cannot be read.
uint32_t Meshes::material_of(const JsonValue& primitive) {
    std::optional<uint32_t> material;
    read_or_leave_out(fmt::format("the material of {}", primitive.pointer()), sink_,
                      [&] { material = materials_.material_of(primitive); });
    return material ? *material : materials_.default_material();
}

void Meshes::check_texture_coordinates(const Part& part) {
    const Mesh& mesh = scene_.meshes[part.mesh];
    const Material& material = scene_.materials[part.material];
    for (const TextureRef* texture : material.textures()) {
        if (!mesh.uv[texture->uv_set].empty()) continue;
        sink_.warn(
            {FileLocation{document_.file()},
             fmt::format(
                 "{}: a texture uses TEXCOORD_{}, which a mesh with this material lacks; the texel at (0, 0) is used",
                 material.origin, sets_of(part.material)[texture->uv_set])});
    }
}

std::optional<uint32_t> Meshes::mesh_of(const JsonValue& primitive, uint32_t node, const std::string& name,
                                        const TextureSets& sets) {
    const std::string key = fmt::format("{};{}", data_key(primitive, node), fmt::join(sets, ","));
    const auto [entry, is_new] = by_data_.try_emplace(key);
    if (!is_new) return entry->second;
    std::optional<Primitive> read = read_primitive({document_, buffers_, primitive, geometry_only_, sets}, sink_);
    if (!read) return std::nullopt;
    buffers_.charge(name.size(), primitive);
    read->mesh.name = name;
    read->mesh.origin = primitive.pointer();
    const std::size_t meshes = scene_.meshes.size(), shapes = scene_.shapes.size();
    scene_.meshes.push_back(std::move(read->mesh));
    try {
        if (!read->targets.empty() || scene_.nodes[node].skin != kNoSkin) {
            add_shape(primitive, node, std::move(read->targets));
        }
    } catch (const Error&) { // the caller reports it
        scene_.meshes.resize(meshes);
        scene_.shapes.resize(shapes);
        throw;
    }
    entry->second = static_cast<uint32_t>(scene_.meshes.size() - 1);
    return entry->second;
}

/// Adds the deformation of the last mesh, and sets its vertices to rest.
void Meshes::add_shape(const JsonValue& primitive, uint32_t node, std::vector<MorphTarget> targets) {
    Mesh& mesh = scene_.meshes.back();
    buffers_.charge(mesh.positions.size() * sizeof(Vec3) + mesh.normals.size() * sizeof(Vec3) +
                        mesh.tangents.size() * sizeof(Vec4),
                    primitive);
    MeshShape& shape = scene_.shapes.emplace_back();
    shape.mesh = static_cast<uint32_t>(scene_.meshes.size() - 1);
    shape.node = node;
    shape.skin = scene_.nodes[node].skin;
    shape.positions = mesh.positions;
    shape.normals = mesh.normals;
    shape.tangents = mesh.tangents;
    shape.targets = std::move(targets);
    std::span<const Transform> joints;
    if (shape.skin != kNoSkin) {
        joints = joints_of(shape.skin);
        read_joint_weights(document_, buffers_, primitive.at("attributes"), joints.size(), shape, sink_);
    }
    shape_mesh(shape, scene_.nodes[node].morph_weights, joints, mesh);
}

const std::vector<Transform>& Meshes::joints_of(uint32_t index) {
    const auto [entry, is_new] = joints_.try_emplace(index);
    if (!is_new) return entry->second;
    Skin& skin = scene_.skins[index];
    const JsonValue& source = document_.table("skins")[index];
    read_or_leave_out(fmt::format("{}/inverseBindMatrices", source.pointer()), sink_, [&] {
        skin.joint_from_mesh = read_inverse_bind_matrices(document_, buffers_, source, skin.joints.size());
    });
    return entry->second = joint_transforms(skin, nodes_.world_from_node());
}

} // namespace pertev::gltf
