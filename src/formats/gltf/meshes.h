#pragma once

// Converts glTF meshes to Scene meshes. A glTF mesh is a list of primitives, each with a material. Each primitive
// becomes one Scene mesh, and primitives with the same data at all times, whatever their material, share one.

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "formats/gltf/materials.h"
#include "formats/gltf/node_graph.h"
#include "formats/gltf/primitive.h"
#include "scene/scene.h"

namespace pertev::gltf {

class Meshes {
public:
    struct Part {
        uint32_t mesh;     // index into scene.meshes
        uint32_t material; // index into scene.materials
    };

    /// Reads meshes on demand for a scene that has its nodes, skins and clips.
    Meshes(const Document& document, Buffers& buffers, const NodeGraph& nodes, Materials& materials, Scene& scene,
           bool geometry_only, Sink& sink);

    /// The drawable parts, at rest, of the mesh that node `index` (which has one) shows. With a skin they are in
    /// world space. An unreadable part is left out with a warning.
    const std::vector<Part>& parts_of(uint32_t index);

private:
    std::vector<Part> read_parts(uint32_t index);
    uint32_t material_of(const JsonValue& primitive);
    void check_texture_coordinates(const Part& part);
    const TextureSets& sets_of(uint32_t material);
    std::optional<uint32_t> mesh_of(const JsonValue& primitive, uint32_t node, const std::string& name,
                                    const TextureSets& sets);
    void add_shape(const JsonValue& primitive, uint32_t node, std::vector<MorphTarget> targets);
    const std::vector<Transform>& joints_of(uint32_t skin);
    std::string use_key(uint32_t node) const;
    std::string data_key(const JsonValue& primitive, uint32_t node) const;

    const Document& document_;
    Buffers& buffers_;
    const NodeGraph& nodes_;
    Materials& materials_;
    Scene& scene_;
    bool geometry_only_;
    Sink& sink_;
    std::map<std::string, std::vector<Part>> by_use_;        // several nodes may show the same
    std::map<std::string, std::optional<uint32_t>> by_data_; // nothing: not drawable
    std::map<uint32_t, TextureSets> sets_;                   // by material
    std::map<uint32_t, std::vector<Transform>> joints_;      // [skin] at rest
    std::set<uint32_t> reshaped_nodes_;                      // nodes whose morph weights an animation changes
};

} // namespace pertev::gltf
