#include "accel/bvh/skip_bvh.h"

#include <fmt/format.h>

#include "base/error.h"

namespace pertev {
namespace {

bool holds(const SkipNode& node, Vec3 lo, Vec3 hi) {
    return node.lo.x <= lo.x && node.lo.y <= lo.y && node.lo.z <= lo.z && hi.x <= node.hi.x && hi.y <= node.hi.y &&
           hi.z <= node.hi.z;
}

/// Checks the leaf at node i and marks its triangles as seen. Returns what is wrong, or nothing.
std::optional<std::string> find_leaf_fault(const SkipBvh& bvh, std::size_t i, bool boxes_hold_triangles,
                                           std::vector<bool>& seen) {
    const SkipNode& node = bvh.nodes[i];
    if (!(node.leaf & kLeafBit)) return fmt::format("node {} has a leaf that is none", i);
    if (node.next != i + 1) return fmt::format("leaf {} goes on at {}", i, node.next);
    for (uint64_t k = node.leaf & ~kLeafBit;; ++k) {
        if (k >= bvh.triangles.size()) return fmt::format("leaf {} runs past triangle {}", i, k);
        if (seen[k]) return fmt::format("triangle {} is reached twice", k);
        seen[k] = true;
        const BvhTriangle& t = bvh.triangles[k];
        if (boxes_hold_triangles && !holds(node, min(min(t.a, t.b), t.c), max(max(t.a, t.b), t.c))) {
            return fmt::format("triangle {} is outside its leaf {}", k, i);
        }
        if (t.flags & kLastInLeaf) return std::nullopt;
    }
}

} // namespace

SkipBvh make_skip_bvh(const Bvh& bvh) {
    SkipBvh skip = {{}, bvh.triangles, bvh.bounds};
    if (bvh.root == kNoLink) return skip;
    // inner nodes, and one leaf more than these; `next` must be able to name the end
    const uint64_t count = 2 * static_cast<uint64_t>(bvh.nodes.size()) + 1;
    if (count >= kNoLink) {
        throw Error(ErrorCode::OverLimit, fmt::format("{} nodes with skip links; the limit is {}", count, kNoLink - 1));
    }
    skip.nodes.reserve(count);
    struct Pending {
        uint32_t link;
        Bounds3 box;
        uint32_t opened; // kNoLink before it is opened; then its node in the list, whose subtree is now complete
    };
    std::vector<Pending> pending = {{bvh.root, bvh.bounds, kNoLink}};
    while (!pending.empty()) {
        const Pending at = pending.back();
        pending.pop_back();
        const auto size = static_cast<uint32_t>(skip.nodes.size());
        if (at.opened != kNoLink) {
            skip.nodes[at.opened].next = size;
        } else if (at.link & kLeafBit) {
            skip.nodes.push_back({at.box.lo, size + 1, at.box.hi, at.link});
        } else {
            skip.nodes.push_back({at.box.lo, 0, at.box.hi, kNoLink});
            const BvhNode& node = bvh.nodes[at.link];
            pending.push_back({at.link, at.box, size});
            for (int k = 1; k >= 0; --k) pending.push_back({node.child[k], child_bounds(node, k), kNoLink});
        }
    }
    return skip;
}

SkipBvhView view_of(const SkipBvh& bvh) {
    return {bvh.nodes.data(), bvh.triangles.data(), static_cast<uint32_t>(bvh.nodes.size()),
            bvh.nodes.empty() ? 0.0f : bvh.bounds.max_abs()};
}

std::optional<std::string> find_fault(const SkipBvh& bvh, bool boxes_hold_triangles) {
    std::vector<bool> seen(bvh.triangles.size());
    std::vector<std::size_t> open; // inner nodes whose subtrees contain the current node
    for (std::size_t i = 0; i < bvh.nodes.size(); ++i) {
        while (!open.empty() && bvh.nodes[open.back()].next == i) open.pop_back();
        const SkipNode& node = bvh.nodes[i];
        const std::size_t end = open.empty() ? bvh.nodes.size() : bvh.nodes[open.back()].next;
        if (open.empty() && i > 0) return fmt::format("node {} is beneath no other", i);
        if (node.next <= i || node.next > end) return fmt::format("node {} goes on at {}", i, node.next);
        if (!open.empty() && !holds(bvh.nodes[open.back()], node.lo, node.hi)) {
            return fmt::format("node {} is outside node {}", i, open.back());
        }
        if (node.leaf == kNoLink) {
            if (node.next < i + 3) return fmt::format("inner node {} has not got two children", i);
            open.push_back(i);
        } else if (auto fault = find_leaf_fault(bvh, i, boxes_hold_triangles, seen)) {
            return fault;
        }
    }
    if (!bvh.nodes.empty() && bvh.nodes[0].next != bvh.nodes.size()) return "the root does not end at the end";
    for (std::size_t k = 0; k < seen.size(); ++k) {
        if (!seen[k]) return fmt::format("triangle {} is not reached", k);
    }
    return std::nullopt;
}

} // namespace pertev
