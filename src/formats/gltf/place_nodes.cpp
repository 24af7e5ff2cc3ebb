#include "formats/gltf/place_nodes.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/limits.h"
#include "base/message_text.h"
#include "formats/gltf/accessor.h"
#include "formats/gltf/camera.h"
#include "formats/gltf/leave_out.h"
#include "formats/gltf/light.h"

namespace pertev::gltf {
namespace {

// The transforms of the instances that EXT_mesh_gpu_instancing places within the node.
std::vector<Transform> read_placements(const Document& document, Buffers& buffers, const JsonValue& instancing) {
    const JsonValue attributes = instancing.at("attributes");
    std::optional<uint64_t> count;
    const auto find = [&](std::string_view name, ElementType type) {
        const std::optional<JsonValue> reference = attributes.find(name);
        std::optional<Accessor> accessor;
        if (!reference) return accessor;
        accessor.emplace(document, buffers, *reference, std::initializer_list<ElementType>{type});
        if (count && *count != accessor->count()) {
            throw reference->error(
                fmt::format("{} elements; expected {} as in the previous attributes", accessor->count(), *count));
        }
        count = accessor->count();
        return accessor;
    };
    const auto translations = find("TRANSLATION", ElementType::Vec3);
    const auto rotations = find("ROTATION", ElementType::Vec4);
    const auto scales = find("SCALE", ElementType::Vec3);
    if (!count) return {Transform()};

    const std::vector<Vec3> t = translations ? translations->read_vec3() : std::vector<Vec3>();
    const std::vector<Vec4> r = rotations ? rotations->read_vec4() : std::vector<Vec4>();
    const std::vector<Vec3> s = scales ? scales->read_vec3() : std::vector<Vec3>();
    buffers.charge(*count * sizeof(Transform), attributes);
    std::vector<Transform> placements;
    for (std::size_t i = 0; i < *count; ++i) {
        const Vec4 rotation = r.empty() || r[i] == Vec4{} ? Vec4{0, 0, 0, 1} : r[i];
        NodePose pose;
        pose.rotation = {static_cast<double>(rotation.x), static_cast<double>(rotation.y),
                         static_cast<double>(rotation.z), static_cast<double>(rotation.w)};
        if (!t.empty()) pose.translation = to_double(t[i]);
        if (!s.empty()) pose.scale = to_double(s[i]);
        placements.push_back(world_from_node(transform_of(pose), {0, 0, 0}));
    }
    return placements;
}

bool is_near(const Transform& world_from_local) {
    return is_finite(world_from_local) && max_component(abs(world_from_local.translation)) <= kMaxCoordinate;
}

// Explains why a scene has no instances: what there is, and what would be right.
std::string describe_nothing(const Document& document, const NodeGraph& nodes) {
    const std::size_t meshes = document.table("meshes").size(), shown = nodes.scene_nodes().size();
    if (meshes == 0) return "/meshes: the file has no meshes; expected one that a node of the scene uses";
    const bool is_shown = std::any_of(nodes.scene_nodes().begin(), nodes.scene_nodes().end(), [&](uint32_t node) {
        return document.table("nodes")[node].find("mesh").has_value();
    });
    if (is_shown)
        return "/meshes: no mesh that a node of the scene uses has a triangle; expected at least one triangle";
    return fmt::format(
        "/nodes: the scene has {}, and none of them uses a mesh (the file has {}); expected a \"mesh\" in one of them",
        counted(shown, "node"), meshes);
}

/// Adds what nodes place to a scene.
class Placing {
public:
    Placing(const Document& document, Buffers& buffers, const NodeGraph& nodes, Meshes& meshes, Scene& scene,
            Sink& sink)
        : document_(document), buffers_(buffers), nodes_(nodes), meshes_(meshes), scene_(scene), sink_(sink) {}

    /// Adds the node's mesh, camera and light, or leaves out those that cannot be read.
    void place(uint32_t index) {
        const JsonValue& node = document_.table("nodes")[index];
        const auto attempt = [&](const char* what, const auto& add) {
            read_or_leave_out(fmt::format("the {} of {}", what, node.pointer()), sink_, add);
        };
        attempt("mesh", [&] {
            if (node.find("mesh") && !nodes_.is_hidden(index)) place_mesh(node, index);
        });
        attempt("camera", [&] {
            if (const auto reference = node.find("camera")) place_camera(node, *reference, index);
        });
        attempt("light", [&] {
            if (!nodes_.is_hidden(index)) place_emitter(node, index);
        });
    }

private:
    void place_mesh(const JsonValue& node, uint32_t index) {
        const std::vector<Meshes::Part>& parts = meshes_.parts_of(index);
        const std::optional<JsonValue> instancing = node.extension("EXT_mesh_gpu_instancing");
        const bool has_skin = scene_.nodes[index].skin != kNoSkin; // its joints have moved it already
        std::vector<Transform> node_from_local(1);
        if (instancing && !has_skin) {
            read_or_leave_out(*instancing, sink_,
                              [&] { node_from_local = read_placements(document_, buffers_, *instancing); });
        }
        const std::string& name = scene_.nodes[index].name;
        buffers_.charge(node_from_local.size() * parts.size() * (sizeof(Instance) + name.size()), node);
        for (const Transform& m : node_from_local) {
            const Transform world_from_local =
                has_skin ? Transform() : placed_in(nodes_.transform(index), m, {0, 0, 0});
            if (!is_near(world_from_local)) {
                sink_.leave_out({node.location(), "the mesh lies beyond 2^40 metres and is left out"});
                continue;
            }
            for (const Meshes::Part& part : parts) {
                scene_.instances.push_back({.name = name,
                                            .mesh = part.mesh,
                                            .material = part.material,
                                            .world_from_local = world_from_local,
                                            .node = index,
                                            .node_from_local = m});
            }
        }
        if (scene_.instances.size() > kMaxInstances) {
            throw Error(ErrorCode::OverLimit, node.location(), fmt::format("more than {} instances", kMaxInstances));
        }
    }

    void place_camera(const JsonValue& node, const JsonValue& reference, uint32_t index) {
        Camera camera = read_camera(document_.item("cameras", reference), sink_);
        if (camera.name.empty()) camera.name = scene_.nodes[index].name;
        camera.origin = node.pointer();
        camera.node = index;
        const std::optional<Transform> rigid = without_scale(nodes_.world_from_node(index));
        if (rigid && !is_near(*rigid)) throw node.error("the camera lies beyond 2^40 metres");
        if (rigid) {
            camera.world_from_camera = *rigid;
            scene_.cameras.push_back(std::move(camera));
        } else {
            sink_.leave_out({node.location(), "the camera's transform is singular; it is left out"});
        }
    }

    void place_emitter(const JsonValue& node, uint32_t index) {
        const std::optional<JsonValue> extension = node.extension("KHR_lights_punctual");
        if (!extension) return;
        Light light = read_light(document_.item("lights", extension->at("light")), sink_);
        if (light.name.empty()) light.name = scene_.nodes[index].name;
        light.origin = node.pointer();
        light.node = index;
        const Transform& world_from_node = nodes_.world_from_node(index);
        if (!is_near(world_from_node)) {
            throw node.error("the light lies beyond 2^40 metres");
        }
        if (place_light(world_from_node, light)) {
            scene_.lights.push_back(std::move(light));
        } else {
            sink_.leave_out({node.location(), "the light's transform is singular; it is left out"});
        }
    }

    const Document& document_;
    Buffers& buffers_;
    const NodeGraph& nodes_;
    Meshes& meshes_;
    Scene& scene_;
    Sink& sink_;
};

} // namespace

void place_nodes(const Document& document, Buffers& buffers, const NodeGraph& nodes, Meshes& meshes, Scene& scene,
                 Sink& sink) {
    const std::size_t before = sink.messages().left_out().size();
    Placing placing(document, buffers, nodes, meshes, scene, sink);
    for (const uint32_t index : nodes.scene_nodes()) {
        sink.check();
        placing.place(index);
    }
    if (!scene.instances.empty()) return;
    scene.no_instances = describe_nothing(document, nodes);
    const std::vector<std::string> left_out = sink.messages().left_out();
    if (left_out.empty()) return;
    // The first part that was left out here, where meshes are read, has the reason; otherwise the first of all.
    const std::size_t first = before < left_out.size() ? before : 0;
    scene.no_instances += fmt::format("; left out: {}", left_out[first]);
}

} // namespace pertev::gltf
