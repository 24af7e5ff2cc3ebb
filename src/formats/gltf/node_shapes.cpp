#include "formats/gltf/node_shapes.h"

#include <algorithm>

namespace pertev::gltf {
namespace {

/// Morph targets of each mesh: the most that a primitive of it has (the format wants the same of all).
std::vector<std::size_t> count_targets(const Document& document) {
    std::vector<std::size_t> counts;
    for (const JsonValue& mesh : document.table("meshes")) {
        std::size_t most = 0;
        for (const JsonValue& primitive : mesh.elements_of("primitives")) {
            if (const auto targets = primitive.find("targets")) most = std::max(most, targets->elements().size());
        }
        counts.push_back(most);
    }
    return counts;
}

/// The weights at rest of the morph targets: the node's own, else its mesh's, by target.
std::vector<float> read_weights(const JsonValue& node, const JsonValue& mesh) {
    const JsonValue& source = node.find("weights") ? node : mesh;
    std::vector<float> weights;
    for (const JsonValue& weight : source.elements_of("weights")) weights.push_back(weight.to_float());
    return weights;
}

} // namespace

void read_node_shapes(const Document& document, Buffers& buffers, Scene& scene) {
    for (const JsonValue& skin : document.table("skins")) {
        const std::vector<JsonValue> joints = skin.at("joints").elements();
        scene.skins.emplace_back();
        for (const JsonValue& joint : joints) scene.skins.back().joints.push_back(document.index_into("nodes", joint));
    }
    const std::vector<JsonValue>& sources = document.table("nodes");
    const std::vector<std::size_t> targets = count_targets(document);
    for (std::size_t i = 0; i < sources.size(); ++i) {
        const std::optional<JsonValue> reference = sources[i].find("mesh");
        if (!reference) continue;
        if (const auto skin = sources[i].find("skin")) scene.nodes[i].skin = document.index_into("skins", *skin);
        const uint32_t mesh = document.index_into("meshes", *reference);
        if (targets[mesh] == 0) continue;
        buffers.charge(targets[mesh] * sizeof(float), sources[i]);
        scene.nodes[i].morph_weights = read_weights(sources[i], document.table("meshes")[mesh]);
        scene.nodes[i].morph_weights.resize(targets[mesh]);
    }
}

} // namespace pertev::gltf
