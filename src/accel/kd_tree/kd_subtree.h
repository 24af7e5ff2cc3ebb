#pragma once

// The recursion that all builders of kd-trees share. A splitter decides where a node is split and what its halves
// hold:
//   using Node                            derived from KdBuildNode
//   optional<KdPlane> split(node, below, above)    fills count and contents of the halves; nothing: a leaf
//   vector<uint32_t> triangles_of(node)   ascending
// Two large halves are built in parallel into arrays of their own, which are joined in a fixed order. A sink may end
// the build at each large node.

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "accel/kd_tree/kd_tree.h"
#include "base/error.h"
#include "base/parallel_for.h"
#include "base/sink.h"

namespace pertev {

struct KdPlane {
    int axis;
    float at; // inside the cell, not on its sides
};

struct KdBuildNode {
    Bounds3 cell;
    uint32_t count = 0;  // triangles that reach into the cell
    int levels = 0;      // number of splits that are still allowed below
    uint64_t budget = 0; // maximum number of references of all leaves below; >= count
};

struct KdSubtree {
    std::vector<KdTreeNode> nodes;
    std::vector<uint32_t> references;
    int depth = 0;

    void check_size() const {
        if (nodes.size() >= kMaxKdTreeNodes || references.size() > 0xffffffffu) {
            throw Error(ErrorCode::OverLimit, "the kd-tree has more than 2^30 nodes or 2^32 references");
        }
    }
    void append(const KdSubtree& other) {
        const auto node_offset = static_cast<uint32_t>(nodes.size());
        const auto reference_offset = static_cast<uint32_t>(references.size());
        for (const KdTreeNode& n : other.nodes) {
            nodes.push_back(n.is_leaf() ? make_kd_leaf(n.first() + reference_offset, n.count())
                                        : make_kd_inner(n.axis(), n.plane(), n.above() + node_offset));
        }
        references.insert(references.end(), other.references.begin(), other.references.end());
        check_size();
    }
};

/// Shares the rest of the parent's budget in proportion to the contents of the halves.
inline void share_budget(const KdBuildNode& parent, KdBuildNode& below, KdBuildNode& above) {
    const uint64_t held = uint64_t(below.count) + above.count, spare = parent.budget - held;
    const uint64_t share = held == 0 ? 0 : spare / held * below.count + spare % held * below.count / held;
    below.budget = below.count + share;
    above.budget = above.count + (spare - share);
}

template <class Splitter>
void build_kd_subtree(const Splitter& splitter, typename Splitter::Node&& node, int depth, KdSubtree& out, Sink& sink) {
    constexpr uint32_t kParallelSubtree = 1u << 12; // from this many triangles on, both halves are built in parallel
    const bool parallel = node.count >= kParallelSubtree;
    if (parallel) sink.check();
    typename Splitter::Node below, above;
    const std::optional<KdPlane> plane = node.levels > 0 ? splitter.split(node, below, above) : std::nullopt;
    if (!plane) {
        const std::vector<uint32_t> ids = splitter.triangles_of(node);
        out.nodes.push_back(
            make_kd_leaf(static_cast<uint32_t>(out.references.size()), static_cast<uint32_t>(ids.size())));
        out.references.insert(out.references.end(), ids.begin(), ids.end());
        out.depth = std::max(out.depth, depth);
        return out.check_size();
    }
    below.cell = cell_below(node.cell, plane->axis, plane->at);
    above.cell = cell_above(node.cell, plane->axis, plane->at);
    below.levels = above.levels = node.levels - 1;
    share_budget(node, below, above);
    node = {}; // frees memory for the levels below

    const std::size_t at = out.nodes.size();
    out.nodes.push_back({});
    const auto close = [&] {
        out.nodes[at] = make_kd_inner(plane->axis, plane->at, static_cast<uint32_t>(out.nodes.size()));
    };
    if (!parallel) {
        build_kd_subtree(splitter, std::move(below), depth + 1, out, sink);
        close();
        return build_kd_subtree(splitter, std::move(above), depth + 1, out, sink);
    }
    KdSubtree first, second;
    parallel_invoke([&] { build_kd_subtree(splitter, std::move(below), depth + 1, first, sink); },
                    [&] { build_kd_subtree(splitter, std::move(above), depth + 1, second, sink); });
    out.append(first);
    sink.check();
    close();
    out.append(second);
    out.depth = std::max(out.depth, std::max(first.depth, second.depth));
}

} // namespace pertev
