#include "formats/gltf/node_shapes.h"

#include <algorithm>

#include "formats/gltf/leave_out.h"

namespace pertev::gltf {
namespace {

/// Returns the number of morph targets of each mesh: the maximum over its primitives, which should all have the same.
std::vector<std::size_t> count_targets(const Document& document) {
    std::vector<std::size_t> counts;
    for (const JsonValue& mesh : document.table("meshes")) {
        std::size_t most = 0;
        try {
            for (const JsonValue& primitive : mesh.elements_of("primitives")) {
                if (const auto targets = primitive.find("targets")) most = std::max(most, targets->elements().size());
            }
        } catch (const Error&) { // meshes.cpp reports it for parts that are shown
        }
        counts.push_back(most);
    }
    return counts;
}

/// Returns the weights of the morph targets at rest: the node's own, otherwise its mesh's.
std::vector<float> read_weights(const JsonValue& node, const JsonValue& mesh, Sink& sink) {
    const std::optional<JsonValue> own = node.find("weights"), source = own ? own : mesh.find("weights");
    std::vector<float> weights;
    if (!source) return weights;
    read_or_leave_out(*source, sink, [&] {
        for (const JsonValue& weight : source->elements()) weights.push_back(weight.to_float());
    });
    return weights;
}

} // namespace

void read_node_shapes(const Document& document, Buffers& buffers, Scene& scene, Sink& sink) {
    std::vector<bool> is_skin; // has all its joints
    for (const JsonValue& skin : document.table("skins")) {
        scene.skins.emplace_back();
        is_skin.push_back(read_or_leave_out(skin, sink, [&] {
            for (const JsonValue& joint : skin.at("joints").elements()) {
                scene.skins.back().joints.push_back(document.index_into("nodes", joint));
            }
        }));
        if (!is_skin.back()) scene.skins.back() = {};
    }
    const std::vector<JsonValue>& sources = document.table("nodes");
    const std::vector<std::size_t> targets = count_targets(document);
    const auto read = [&](std::size_t i) {
        const std::optional<JsonValue> reference = sources[i].find("mesh");
        if (!reference) return;
        if (const auto skin = sources[i].find("skin")) {
            read_or_leave_out(*skin, sink, [&] {
                const uint32_t index = document.index_into("skins", *skin);
                if (is_skin[index]) scene.nodes[i].skin = index;
            });
        }
        const uint32_t mesh = document.index_into("meshes", *reference);
        if (targets[mesh] == 0) return;
        buffers.charge(targets[mesh] * sizeof(float), sources[i]);
        scene.nodes[i].morph_weights = read_weights(sources[i], document.table("meshes")[mesh], sink);
        scene.nodes[i].morph_weights.resize(targets[mesh]);
    };
    for (std::size_t i = 0; i < sources.size(); ++i) {
        try {
            read(i);
        } catch (const Error& error) { // place_nodes reports it for nodes that are shown
            if (error.code() != ErrorCode::BadInput) throw;
        }
    }
}

} // namespace pertev::gltf
