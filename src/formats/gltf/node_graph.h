#pragma once

// The nodes of a document as a forest: the Scene's nodes, world transforms, and the nodes of the shown scene.
//
// Source: glTF 2.0 section 3.5. Nothing here recurses: a chain of a million nodes is a loop.

#include <cstdint>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "formats/gltf/document.h"
#include "math/transform.h"
#include "scene/node.h"

namespace pertev::gltf {

class NodeGraph {
public:
    /// Reads the nodes. Cycles are cut, and if a node has two parents the first counts, each with a warning. `shown` is
    /// the index of the document's scene that is shown; without scenes all nodes are shown. An animation changes the
    /// visibility of `animated_visibility`. With `base` a further last node, which has this transform and which the
    /// document lacks, holds all others.
    NodeGraph(const Document& document, uint32_t shown, const std::set<uint32_t>& animated_visibility, Sink& sink,
              const std::optional<NodeTransform>& base = {});

    /// The scene's nodes, each before its children, in the order of the file.
    const std::vector<uint32_t>& scene_nodes() const { return scene_nodes_; }
    /// Returns whether KHR_node_visibility hides a node, by itself or by an ancestor, and no animation can show it.
    bool is_hidden(uint32_t node) const { return is_hidden_[node]; }
    /// Transform of any node, in the scene or not, at rest, in double and as floats in the coordinates of the file.
    const NodeTransform& transform(uint32_t node) const { return transforms_[node]; }
    const Transform& world_from_node(uint32_t node) const { return world_from_node_[node]; }
    const std::vector<Transform>& world_from_node() const { return world_from_node_; }
    /// All nodes of the document, in its order.
    std::vector<Node> take_nodes() { return std::move(nodes_); }

private:
    void read_children(const Document& document, Sink& sink);
    void hold_all(const NodeTransform& base);
    void cut_cycles(const Document& document, Sink& sink);
    void place_nodes(const Document& document, const std::set<uint32_t>& animated_visibility, Sink& sink);
    std::vector<uint32_t> scene_roots(const Document& document, uint32_t shown, Sink& sink) const;
    template <class Visit>
    void for_each_below(const std::vector<uint32_t>& roots, const Visit& visit) const;

    std::vector<std::vector<uint32_t>> children_;
    std::vector<Node> nodes_;
    std::vector<NodeTransform> transforms_;
    std::vector<Transform> world_from_node_;
    std::vector<uint32_t> scene_nodes_;
    std::vector<bool> is_hidden_;
};

} // namespace pertev::gltf
