#include "formats/gltf/node_graph.h"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

#include "formats/gltf/leave_out.h"

namespace pertev::gltf {
namespace {

/// Reads the pose of a node. If a member cannot be read, only that member is left out.
std::variant<NodePose, DoubleTransform> pose_of(const JsonValue& node, Sink& sink) {
    std::optional<std::array<double, 16>> m; // by columns
    const auto attempt = [&](const char* key, const auto& read) { read_member(node, key, sink, read); };
    attempt("matrix", [&](const JsonValue& matrix) { m = matrix.to_doubles<16>(); });
    if (m) {
        const std::array<double, 16>& a = *m;
        return DoubleTransform{{a[0], a[4], a[8]}, {a[1], a[5], a[9]}, {a[2], a[6], a[10]}, {a[12], a[13], a[14]}};
    }
    std::array<double, 3> t = {0, 0, 0}, s = {1, 1, 1};
    std::array<double, 4> r = {0, 0, 0, 1};
    attempt("translation", [&](const JsonValue& translation) { t = translation.to_doubles<3>(); });
    attempt("rotation", [&](const JsonValue& rotation) {
        const std::array<double, 4> read = rotation.to_doubles<4>();
        if (std::ranges::all_of(read, [](double x) { return static_cast<float>(x) == 0; })) {
            throw rotation.error("expected a unit quaternion");
        }
        r = read;
    });
    attempt("scale", [&](const JsonValue& scale) { s = scale.to_doubles<3>(); });
    return NodePose{{t[0], t[1], t[2]}, r, {s[0], s[1], s[2]}};
}

} // namespace

NodeGraph::NodeGraph(const Document& document, uint32_t shown, const std::set<uint32_t>& animated_visibility,
                     Sink& sink, const std::optional<NodeTransform>& base) {
    read_children(document, sink);
    cut_cycles(document, sink);
    const std::vector<uint32_t> roots = scene_roots(document, shown, sink);
    if (base) hold_all(*base);
    place_nodes(document, animated_visibility, sink);
    for_each_below(roots, [&](uint32_t node) { scene_nodes_.push_back(node); });
}

void NodeGraph::hold_all(const NodeTransform& base) {
    const auto holder = static_cast<uint32_t>(nodes_.size());
    for (Node& node : nodes_) {
        if (node.parent == kNoNode) node.parent = holder;
    }
    nodes_.push_back({.pose = base.world_from_node});
}

void NodeGraph::read_children(const Document& document, Sink& sink) {
    const std::vector<JsonValue>& nodes = document.table("nodes");
    children_.resize(nodes.size());
    nodes_.resize(nodes.size());
    const auto read_child = [&](uint32_t node, const JsonValue& reference) {
        const uint32_t child = document.index_into("nodes", reference);
        if (nodes_[child].parent != kNoNode) {
            throw reference.error(
                fmt::format("node {} is already a child of node {}; expected one parent", child, nodes_[child].parent));
        }
        nodes_[child].parent = node;
        children_[node].push_back(child);
    };
    for (uint32_t node = 0; node < nodes.size(); ++node) {
        read_or_leave_out(fmt::format("{}/children", nodes[node].pointer()), sink, [&] {
            for (const JsonValue& reference : nodes[node].elements_of("children")) {
                read_or_leave_out(reference, sink, [&] { read_child(node, reference); });
            }
        });
    }
}

/// Removes the link from a node to its parent if the node is its own ancestor. Nodes that are then below no root of the
/// scene are not shown.
void NodeGraph::cut_cycles(const Document& document, Sink& sink) {
    enum class State : uint8_t { Unseen, OnThisPath, Seen };
    std::vector<State> states(nodes_.size(), State::Unseen);
    std::vector<uint32_t> path;
    for (uint32_t start = 0; start < nodes_.size(); ++start) {
        path.clear();
        uint32_t node = start;
        for (; node != kNoNode && states[node] == State::Unseen; node = nodes_[node].parent) {
            states[node] = State::OnThisPath;
            path.push_back(node);
        }
        if (node != kNoNode && states[node] == State::OnThisPath) {
            const uint32_t parent = nodes_[node].parent;
            std::erase(children_[parent], node);
            nodes_[node].parent = kNoNode;
            sink.leave_out(
                {document.table("nodes")[node].location(),
                 fmt::format("the node is its own ancestor; expected a tree; its link to node {} is left out",
                             parent)});
        }
        for (const uint32_t seen : path) states[seen] = State::Seen;
    }
}

void NodeGraph::place_nodes(const Document& document, const std::set<uint32_t>& animated_visibility, Sink& sink) {
    const std::vector<JsonValue>& nodes = document.table("nodes");
    const std::vector<uint32_t> order = parents_first(nodes_);
    for (uint32_t node = 0; node < nodes.size(); ++node) {
        const auto attempt = [&](const char* what, const auto& read) {
            read_or_leave_out(fmt::format("{} of {}", what, nodes[node].pointer()), sink, read);
        };
        attempt("the name", [&] { nodes_[node].name = nodes[node].string_or("name", ""); });
        attempt("the transform", [&] { nodes_[node].pose = pose_of(nodes[node], sink); });
    }
    is_hidden_.resize(nodes_.size());
    for (const uint32_t node : order) {
        if (node >= nodes.size()) continue; // the one that holds all
        const uint32_t parent = nodes_[node].parent;
        bool is_visible = true;
        read_or_leave_out(nodes[node].pointer() + "/extensions/KHR_node_visibility", sink, [&] {
            if (const auto own = nodes[node].extension("KHR_node_visibility"))
                is_visible = own->bool_or("visible", true);
        });
        if (animated_visibility.contains(node)) nodes_[node].is_visible = std::exchange(is_visible, true);
        is_hidden_[node] = !is_visible || (parent != kNoNode && is_hidden_[parent]);
    }
    transforms_ = transforms_of(nodes_, order);
    world_from_node_ = world_from_nodes(transforms_, {0, 0, 0});
}

std::vector<uint32_t> NodeGraph::scene_roots(const Document& document, uint32_t shown, Sink& sink) const {
    const std::vector<JsonValue>& scenes = document.table("scenes");
    std::vector<uint32_t> roots;
    if (scenes.empty()) { // a library of parts: show all of it
        for (uint32_t node = 0; node < nodes_.size(); ++node) {
            if (nodes_[node].parent == kNoNode) roots.push_back(node);
        }
        return roots;
    }
    // Some exporters list children too. A child is shown once, where its parent puts it.
    std::vector<bool> is_listed(nodes_.size());
    const auto read_root = [&](const JsonValue& reference) {
        const uint32_t node = document.index_into("nodes", reference);
        if (!is_listed[node]) roots.push_back(node);
        is_listed[node] = true;
    };
    read_or_leave_out(fmt::format("{}/nodes", scenes[shown].pointer()), sink, [&] {
        for (const JsonValue& reference : scenes[shown].elements_of("nodes")) {
            read_or_leave_out(reference, sink, [&] { read_root(reference); });
        }
    });
    std::vector<bool> is_below(nodes_.size()); // one that is listed
    for (const uint32_t node : parents_first(nodes_)) {
        const uint32_t parent = nodes_[node].parent;
        is_below[node] = parent != kNoNode && (is_listed[parent] || is_below[parent]);
    }
    std::erase_if(roots, [&](uint32_t node) {
        if (!is_below[node]) return false;
        sink.warn(
            {scenes[shown].location(),
             fmt::format("node {} is listed by the scene and is a descendant of another listed node; it is used once",
                         node)});
        return true;
    });
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
