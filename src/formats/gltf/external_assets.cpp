#include "formats/gltf/external_assets.h"

#include <algorithm>
#include <iterator>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "base/limits.h"
#include "base/message_text.h"
#include "base/read_file.h"
#include "formats/gltf/attached_bytes.h"
#include "formats/gltf/credits.h"
#include "formats/gltf/leave_out.h"
#include "formats/gltf/light.h"
#include "formats/gltf/uri.h"

namespace fs = std::filesystem;

namespace pertev::gltf {
namespace {

constexpr uint32_t kMostAssets = 4096, kMostNested = 64;

/// Numbers that the first element of each list of a part has in the scene to which it is added.
struct Offsets {
    uint32_t meshes, materials, images;
};

void add_to(uint32_t& index, std::size_t offset) { index += static_cast<uint32_t>(offset); }

/// Returns the number of the first object, in the scene, of the kind that a channel changes.
std::size_t first_target(const Scene& to, AnimatedPart part, const Offsets& at) {
    if (is_of_node(part)) return to.nodes.size();
    if (is_of_camera(part)) return to.cameras.size();
    if (is_of_material(part)) return at.materials;
    return to.lights.size();
}

template <class T>
void move_to_end(std::vector<T>& from, std::vector<T>& to) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

/// Adds the materials and textures of a part, whose images begin at `images`.
void append_materials(Scene& part, uint32_t images, Scene& to) {
    for (Material& material : part.materials) {
        visit_textures(material, [&](TextureRef& texture, const char*) {
            if (texture.has_image()) texture.image += static_cast<int32_t>(images);
        });
    }
    move_to_end(part.images, to.images);
    move_to_end(part.materials, to.materials);
}

/// Adds the objects of a part, whose data is at `at`, below a node.
void append_objects(Scene& part, uint32_t node, const Offsets& at, Scene& to) {
    const std::size_t nodes = to.nodes.size(), skins = to.skins.size();
    for (Animation& animation : part.animations) {
        for (AnimationChannel& channel : animation.channels) add_to(channel.target, first_target(to, channel.part, at));
    }
    for (Node& own : part.nodes) {
        if (own.parent != kNoNode) {
            add_to(own.parent, nodes);
        } else { // it holds all others
            own.parent = node;
            own.pose = NodePose{};
        }
        if (own.skin != kNoSkin) add_to(own.skin, skins);
    }
    for (Skin& skin : part.skins) {
        for (uint32_t& joint : skin.joints) add_to(joint, nodes);
    }
    for (MeshShape& shape : part.shapes) {
        add_to(shape.mesh, at.meshes);
        if (shape.node != kNoNode) add_to(shape.node, nodes);
        if (shape.skin != kNoSkin) add_to(shape.skin, skins);
    }
    for (Instance& instance : part.instances) {
        add_to(instance.mesh, at.meshes);
        add_to(instance.material, at.materials);
        add_to(instance.node, nodes);
    }
    for (Light& light : part.lights) add_to(light.node, nodes);
    for (Camera& camera : part.cameras) add_to(camera.node, nodes);
    move_to_end(part.animations, to.animations);
    move_to_end(part.nodes, to.nodes);
    move_to_end(part.skins, to.skins);
    move_to_end(part.shapes, to.shapes);
    move_to_end(part.instances, to.instances);
    move_to_end(part.lights, to.lights);
    move_to_end(part.cameras, to.cameras);
}

bool is_in_reach(const Transform& world_from_local) {
    return is_finite(world_from_local) && max_component(abs(world_from_local.translation)) <= kMaxCoordinate;
}

/// Returns whether the objects of a part can be copied: all of it was placed, and no vertices depend on the place.
bool can_be_copied(const Scene& part, const NodeTransform& base) {
    const Transform world = world_from_node(base, {0, 0, 0});
    const bool has_tables =
        std::ranges::any_of(part.lights, [](const Light& light) { return parts_of(light.kind).table; });
    return part.shapes.empty() && !has_tables && !is_singular(world) && is_in_reach(world);
}

/// Returns the objects of a part, without its meshes, materials and textures, as a node with another transform shows
/// them. What is then beyond the limits, or has a singular transform where it may have none, is left out.
Scene copy_objects(const Scene& part, const NodeTransform& base) {
    Scene copy;
    copy.nodes = part.nodes;
    copy.skins = part.skins;
    copy.animations = part.animations;
    for (Node& node : copy.nodes) {
        if (node.parent == kNoNode) node.pose = base.world_from_node;
    }
    const std::vector<NodeTransform> transforms = transforms_of(copy.nodes, parents_first(copy.nodes));
    const std::vector<Transform> world_from_node = world_from_nodes(transforms, {0, 0, 0});
    for (Instance instance : part.instances) {
        instance.world_from_local = placed_in(transforms[instance.node], instance.node_from_local, {0, 0, 0});
        if (is_in_reach(instance.world_from_local)) copy.instances.push_back(std::move(instance));
    }
    for (Camera camera : part.cameras) {
        const std::optional<Transform> rigid = without_scale(world_from_node[camera.node]);
        if (!rigid || !is_in_reach(*rigid)) continue;
        camera.world_from_camera = *rigid;
        copy.cameras.push_back(std::move(camera));
    }
    for (Light light : part.lights) {
        const Transform& world = world_from_node[light.node];
        if (is_in_reach(world) && place_light(world, light)) copy.lights.push_back(std::move(light));
    }
    return copy;
}

template <class T>
uint64_t bytes_of(const std::vector<T>& objects) {
    uint64_t bytes = objects.size() * sizeof(T);
    if constexpr (requires(const T& object) { object.name.size(); }) {
        for (const T& object : objects) bytes += object.name.size();
    }
    if constexpr (requires(const T& object) { object.origin.size(); }) {
        for (const T& object : objects) bytes += object.origin.size();
    }
    return bytes;
}

/// Returns the memory of a part.
uint64_t bytes_of(const Scene& scene) {
    uint64_t bytes = sizeof(Scene) + bytes_of(scene.nodes) + bytes_of(scene.instances) + bytes_of(scene.lights) +
                     bytes_of(scene.cameras) + bytes_of(scene.skins) + bytes_of(scene.shapes) + bytes_of(scene.meshes) +
                     bytes_of(scene.materials) + bytes_of(scene.animations);
    for (const Animation& animation : scene.animations) {
        for (const AnimationChannel& channel : animation.channels)
            bytes += sizeof channel + (channel.times.size() + channel.values.size()) * sizeof(float);
    }
    for (const Skin& skin : scene.skins) bytes += skin.joints.size() * (sizeof(uint32_t) + sizeof(Transform));
    for (const Mesh& mesh : scene.meshes) {
        bytes += bytes_of(mesh.positions) + bytes_of(mesh.normals) + bytes_of(mesh.tangents) + bytes_of(mesh.colors) +
                 bytes_of(mesh.indices);
        for (const std::vector<Vec2>& uv : mesh.uv) bytes += bytes_of(uv);
    }
    for (const TextureImage& image : scene.images)
        bytes += bytes_of(image.rgba8.pixels) + bytes_of(image.rgba_float.pixels);
    return bytes;
}

} // namespace

ExternalAssets::ExternalAssets(const Document& document, Buffers& buffers, const FileAccess& access,
                               const NodeGraph& nodes, const ReadOptions& options, const AssetPlace& place, Sink& sink)
    : document_(document), buffers_(buffers), access_(access), nodes_(nodes), options_(options), place_(place),
      sink_(sink) {
    if (document.table("externalAssets").empty()) return;
    for (const uint32_t index : nodes.scene_nodes()) {
        sink.check();
        const JsonValue& node = document.table("nodes")[index];
        read_or_leave_out(fmt::format("the external asset of {}", node.pointer()), sink, [&] { read(node, index); });
    }
}

void ExternalAssets::read(const JsonValue& node, uint32_t index) {
    const std::optional<JsonValue> reference = node.find("externalAsset");
    if (!reference || nodes_.is_hidden(index)) return;
    const JsonValue of_file = document_.item("externalAssets", *reference).at("file");
    const uint32_t number = document_.index_into("files", of_file);
    const JsonValue& file = document_.table("files")[number];
    if (met_.insert(number).second && file.find("aliases"))
        sink_.leave_out({file.location(), "the aliases of the file are left out"});
    if (failed_.contains(number)) return; // said for the first node
    try {
        const uint64_t before = place_.budget.scene_bytes;
        Part part = {make_part(number, nodes_.transform(index)), index, number};
        charge(part.scene, before, file);
        parts_.push_back(std::move(part));
    } catch (const Error&) {
        failed_.insert(number);
        throw;
    }
}

Scene ExternalAssets::make_part(uint32_t number, const NodeTransform& base) {
    const JsonValue& file = document_.table("files")[number];
    const auto first = std::ranges::find(parts_, number, &Part::file);
    if (first != parts_.end() && can_be_copied(first->scene, nodes_.transform(first->node)))
        return copy_objects(first->scene, base);
    Scene scene = read_file_of(file, base);
    if (first != parts_.end()) {
        scene.images.clear();
        scene.materials.clear();
        if (scene.shapes.empty()) scene.meshes.clear();
    } else if (scene.environment || scene.clips.size() > 1 || !scene.variants.empty()) {
        sink_.leave_out({file.location(), "the environment, the variants, and all animations but the first of a file "
                                          "that another one shows are left out"});
    }
    return scene;
}

/// Counts a part, which holds what it shows itself, in place of what was counted since the sum was `before`.
void ExternalAssets::charge(const Scene& part, uint64_t before, const JsonValue& file) {
    uint64_t& sum = place_.budget.scene_bytes;
    sum = before + bytes_of(part);
    const uint64_t limit = justified_bytes(kFreeMeshBytes + kFreeImageBytes, place_.budget.file_bytes);
    if (sum <= limit) return;
    sum = before;
    throw file.error(fmt::format("the files that others show take more than {} MB of memory", limit >> 20));
}

Scene ExternalAssets::read_file_of(const JsonValue& file, const NodeTransform& base) {
    std::size_t depth = 0;
    for (const AssetPlace* outer = &place_; outer != nullptr; outer = outer->outer) ++depth;
    if (++place_.budget.reads > kMostAssets || depth > kMostNested) {
        throw file.error(fmt::format("files show more than {} others, or {} in each other", kMostAssets, kMostNested));
    }
    ReadOptions options;
    options.geometry_only = options_.geometry_only;
    options.max_texture_size = options_.max_texture_size;
    AssetPlace inner = {.file = {}, .budget = place_.budget, .outer = &place_, .base = base};
    const std::optional<JsonValue> uri = file.find("uri");
    if (!uri || is_data_uri(uri->to_string())) {
        std::vector<std::byte> owned;
        const std::span<const std::byte> bytes = attached_bytes(document_, buffers_, access_, file, owned, sink_);
        return read_asset(document_.path(), {bytes.begin(), bytes.end()}, access_, options, inner, sink_);
    }
    const std::optional<std::string> name = file_name_of_uri(uri->to_string(), document_.path());
    const std::optional<fs::path> path = name ? access_.find(uri->location(), *name, sink_) : std::nullopt;
    if (!path) throw uri->error("there is no such file");
    std::error_code none;
    inner.file = fs::weakly_canonical(*path, none);
    for (const AssetPlace* outer = &place_; outer != nullptr; outer = outer->outer) {
        if (outer->file == inner.file) throw uri->error("the file shows itself, by itself or through others");
    }
    return read_asset(*path, read_file(*path), access_, options, inner, sink_);
}

void ExternalAssets::append_to(Scene& scene) {
    std::map<uint32_t, Offsets> known; // [file] where the data of its first copy is
    for (Part& part : parts_) {
        Offsets at = {static_cast<uint32_t>(scene.meshes.size()), static_cast<uint32_t>(scene.materials.size()),
                      static_cast<uint32_t>(scene.images.size())};
        const auto [first, is_new] = known.try_emplace(part.file, at);
        if (is_new) {
            append_materials(part.scene, at.images, scene);
            add_credits(part.scene, scene);
        } else {
            at.materials = first->second.materials;
        }
        if (!is_new && part.scene.meshes.empty()) at.meshes = first->second.meshes; // else deformed ones, which differ
        move_to_end(part.scene.meshes, scene.meshes);
        append_objects(part.scene, part.node, at, scene);
        if (scene.instances.size() > kMaxInstances) {
            throw Error(ErrorCode::OverLimit, document_.root().location(),
                        fmt::format("more than {} instances", kMaxInstances));
        }
    }
    if (!scene.instances.empty()) scene.no_instances.clear();
    parts_.clear();
}

} // namespace pertev::gltf
