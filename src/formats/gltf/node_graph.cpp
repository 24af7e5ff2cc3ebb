#include "formats/gltf/node_graph.h"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

namespace pertev::gltf {
namespace {

std::variant<NodePose, Transform> pose_of(const JsonValue& node) {
    if (const std::optional<JsonValue> matrix = node.find("matrix")) {
        const std::array<float, 16> values = matrix->to_floats<16>();
        float columns[16];
        std::copy(values.begin(), values.end(), columns);
        return transform_from_columns(columns);
    }
    const std::array<float, 3> t = node.floats_or<3>("translation", {0, 0, 0});
    const std::array<float, 4> r = node.floats_or<4>("rotation", {0, 0, 0, 1});
    const std::array<float, 3> s = node.floats_or<3>("scale", {1, 1, 1});
    if (r == std::array<float, 4>{0, 0, 0, 0}) throw node.at("rotation").error("expected a unit quaternion");
    return NodePose{{t[0], t[1], t[2]}, {r[0], r[1], r[2], r[3]}, {s[0], s[1], s[2]}};
}

} // namespace

NodeGraph::NodeGraph(const Document& document, uint32_t shown) {
    read_children(document);
    place_nodes(document);
    for_each_below(scene_roots(document, shown), [&](uint32_t node) { scene_nodes_.push_back(node); });
}

void NodeGraph::read_children(const Document& document) {
    const std::vector<JsonValue>& nodes = document.table("nodes");
    children_.resize(nodes.size());
    nodes_.resize(nodes.size());
    for (uint32_t node = 0; node < nodes.size(); ++node) {
        for (const JsonValue& reference : nodes[node].elements_of("children")) {
            const uint32_t child = document.index_into("nodes", reference);
            if (nodes_[child].parent != kNoNode) {
                throw reference.error(fmt::format("node {} is already a child of node {}; expected one parent", child,
                                                  nodes_[child].parent));
            }
            nodes_[child].parent = node;
            children_[node].push_back(child);
        }
    }
}

void NodeGraph::place_nodes(const Document& document) {
    const std::vector<JsonValue>& nodes = document.table("nodes");
    const std::vector<uint32_t> order = parents_first(nodes_);
    if (order.size() < nodes.size()) {
        std::vector<bool> is_placed(nodes.size());
        for (const uint32_t node : order) is_placed[node] = true;
        const auto first = std::ranges::find(is_placed, false) - is_placed.begin();
        throw nodes[static_cast<std::size_t>(first)].error("the node is its own ancestor; expected a tree");
    }
    for (uint32_t node = 0; node < nodes.size(); ++node) {
        nodes_[node].name = nodes[node].string_or("name", "");
        nodes_[node].pose = pose_of(nodes[node]);
    }
    world_from_node_ = world_from_nodes(nodes_, order);
}

std::vector<uint32_t> NodeGraph::scene_roots(const Document& document, uint32_t shown) const {
    const std::vector<JsonValue>& scenes = document.table("scenes");
    std::vector<uint32_t> roots;
    if (scenes.empty()) { // a library of parts: show all of it
        for (uint32_t node = 0; node < nodes_.size(); ++node) {
            if (nodes_[node].parent == kNoNode) roots.push_back(node);
        }
        return roots;
    }
    std::vector<bool> is_listed(nodes_.size());
    for (const JsonValue& reference : scenes[shown].elements_of("nodes")) {
        const uint32_t node = document.index_into("nodes", reference);
        if (nodes_[node].parent != kNoNode || is_listed[node]) {
            throw reference.error(fmt::format("node {} {}; expected each root once", node,
                                              is_listed[node] ? "is listed twice" : "is a child of another node"));
        }
        is_listed[node] = true;
        roots.push_back(node);
    }
    return roots;
}

template <class Visit>
void NodeGraph::for_each_below(const std::vector<uint32_t>& roots, const Visit& visit) const {
    std::vector<uint32_t> waiting(roots.rbegin(), roots.rend());
    while (!waiting.empty()) {
        const uint32_t node = waiting.back();
        waiting.pop_back();
        visit(node);
        waiting.insert(waiting.end(), children_[node].rbegin(), children_[node].rend());
    }
}

} // namespace pertev::gltf
