#include "accel/bvh/check_bvh.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/limits.h"

namespace pertev {

std::optional<std::string> find_broken_link(const Bvh& bvh, Sink& sink) {
    if (bvh.root == kNoLink) {
        if (!bvh.nodes.empty() || !bvh.triangles.empty()) return "the tree has nodes or triangles but no root";
        return std::nullopt;
    }
    struct Pending {
        uint32_t link;
        int depth;
    };
    std::vector<bool> node_seen(bvh.nodes.size()), triangle_seen(bvh.triangles.size());
    std::size_t nodes = 0, triangles = 0;
    std::vector<Pending> pending = {{bvh.root, 0}};
    int depth = 0;
    while (!pending.empty()) {
        const Pending at = pending.back();
        pending.pop_back();
        depth = std::max(depth, at.depth);
        if (at.link == kNoLink) return "an inner node has no child";
        if (at.link & kLeafBit) {
            for (uint64_t i = at.link & ~kLeafBit;; ++i) {
                if (i >= bvh.triangles.size()) return fmt::format("a leaf extends beyond triangle {}", i);
                if (triangle_seen[i]) return fmt::format("triangle {} is reached twice", i);
                triangle_seen[i] = true;
                ++triangles;
                if (bvh.triangles[i].flags & kLastInLeaf) break;
            }
            continue;
        }
        if (at.link >= bvh.nodes.size()) return fmt::format("a link to node {} of {}", at.link, bvh.nodes.size());
        sink.check_at(nodes);
        if (node_seen[at.link]) return fmt::format("node {} is reached twice", at.link);
        node_seen[at.link] = true;
        ++nodes;
        if (at.depth >= kMaxBvhDepth) return fmt::format("node {} is deeper than {}", at.link, kMaxBvhDepth);
        for (const uint32_t child : bvh.nodes[at.link].child) pending.push_back({child, at.depth + 1});
    }
    if (nodes != bvh.nodes.size()) return fmt::format("{} of {} nodes are reached", nodes, bvh.nodes.size());
    if (triangles != bvh.triangles.size()) {
        return fmt::format("{} of {} triangles are reached", triangles, bvh.triangles.size());
    }
    if (depth != bvh.depth) return fmt::format("the depth is {}, but the tree states {}", depth, bvh.depth);
    return std::nullopt;
}

} // namespace pertev
