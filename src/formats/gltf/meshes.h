#pragma once

// glTF meshes as Scene meshes. A glTF mesh is a list of parts (primitives), each with a material: each part becomes one
// Scene mesh, and parts with the same data, whatever their material, share one.

#include <map>
#include <optional>
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

    Meshes(const Document& document, Buffers& buffers, const NodeGraph& nodes, Materials& materials, Scene& scene,
           bool geometry_only, Messages& messages)
        : document_(document), buffers_(buffers), nodes_(nodes), materials_(materials), scene_(scene),
          geometry_only_(geometry_only), messages_(messages) {}

    /// The drawable parts of the mesh that `node` (which has one) shows. With a skin they are in world space.
    const std::vector<Part>& parts_of(const JsonValue& node);

private:
    std::vector<Part> read_parts(const JsonValue& node);
    void check_texture_coordinates(const Part& part);
    std::optional<uint32_t> mesh_of(const JsonValue& primitive, const std::vector<float>& weights,
                                    const std::optional<JsonValue>& skin, const std::string& name);
    const std::vector<Transform>& joints_of(const JsonValue& skin);

    const Document& document_;
    Buffers& buffers_;
    const NodeGraph& nodes_;
    Materials& materials_;
    Scene& scene_;
    bool geometry_only_;
    Messages& messages_;
    std::map<std::string, std::vector<Part>> by_use_;        // what one node shows, another may show too
    std::map<std::string, std::optional<uint32_t>> by_data_; // nothing: not drawable
    std::map<uint32_t, std::vector<Transform>> joints_;      // by skin
};

} // namespace pertev::gltf
