#include "accel/bvh/wide_bvh.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/huge_pages.h"
#include "base/limits.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

using Subtree = CollapsedTree::Subtree;

template <int kWidth>
void set_child(WideBvhNode<kWidth>& node, int k, const Bounds3& box, uint32_t link, uint32_t count) {
    const float planes[6] = {box.lo.x, box.hi.x, box.lo.y, box.hi.y, box.lo.z, box.hi.z};
    for (int p = 0; p < 6; ++p) node.planes[p][k] = planes[p];
    node.child[k] = link;
    node.count[k] = count;
}

template <int kWidth>
Bounds3 child_bounds(const WideBvhNode<kWidth>& node, int k) {
    return {{node.planes[0][k], node.planes[2][k], node.planes[4][k]},
            {node.planes[1][k], node.planes[3][k], node.planes[5][k]}};
}

/// Makes the node of a subtree. Inner children still name subtrees.
template <int kWidth>
WideBvhNode<kWidth> make_node(const CollapsedTree& tree, uint32_t subtree) {
    uint32_t children[kMaxWidth];
    const int count = tree.children_of(subtree, children);
    WideBvhNode<kWidth> node;
    for (int k = 0; k < kWidth; ++k) {
        if (k >= count) {
            set_child(node, k, Bounds3{}, kNoLink, 0);
            continue;
        }
        const Subtree& child = tree.subtrees()[children[k]];
        const bool leaf = tree.is_leaf(children[k]);
        set_child(node, k, child.box, leaf ? kLeafBit | child.first : children[k], leaf ? child.count : 0);
    }
    return node;
}

/// Assembles nodes, depth and cost, without triangles.
template <int kWidth>
WideBvh<kWidth> assemble(const Bvh& bvh, const CollapseSettings& settings, Sink& sink) {
    const CollapsedTree tree(bvh, settings, kWidth, sink);
    WideBvh<kWidth> wide;
    wide.bounds = bvh.bounds;
    if (tree.subtrees().empty()) return wide;
    struct Pending {
        uint32_t subtree, parent;
        int k, depth;
    };
    double cost = 0;
    std::vector<Pending> pending = {{0, kNoLink, 0, 1}};
    while (!pending.empty()) {
        const Pending at = pending.back();
        pending.pop_back();
        const auto index = static_cast<uint32_t>(wide.nodes.size());
        sink.check_at(index);
        if (at.parent != kNoLink) wide.nodes[at.parent].child[at.k] = index;
        const WideBvhNode<kWidth>& node = wide.nodes.emplace_back(make_node<kWidth>(tree, at.subtree));
        wide.depth = max(wide.depth, at.depth);
        cost += static_cast<double>(tree.subtrees()[at.subtree].box.half_area() * settings.node_cost);
        for (int k = kWidth - 1; k >= 0; --k) {
            if (node.child[k] == kNoLink) continue;
            if (node.child[k] & kLeafBit) {
                const float step_cost = CollapsedTree::leaf_cost(settings, node.count[k]);
                cost += static_cast<double>(child_bounds(node, k).half_area() * step_cost);
            } else {
                pending.push_back({node.child[k], index, k, at.depth + 1});
            }
        }
    }
    if (wide.depth > kMaxBvhDepth) {
        throw Error(ErrorCode::OverLimit, fmt::format("a tree with {} children per node has {} levels; the limit is {}",
                                                      kWidth, wide.depth, kMaxBvhDepth));
    }
    const float area = bvh.bounds.half_area();
    wide.sah_cost = area > 0 ? static_cast<float>(cost / static_cast<double>(area)) : 0;
    return wide;
}

} // namespace

template <int kWidth>
WideBvh<kWidth> make_wide_bvh(const Bvh& bvh, const CollapseSettings& settings, Sink& sink) {
    WideBvh<kWidth> wide;
    std::vector<BvhTriangle> triangles;
    parallel_invoke([&] { wide = assemble<kWidth>(bvh, settings, sink); },
                    [&] {
                        reserve_on_huge_pages(triangles, bvh.triangles.size());
                        for (const BvhTriangle& t : bvh.triangles) {
                            sink.check_at(triangles.size());
                            triangles.emplace_back(t).flags &= ~kLastInLeaf;
                        }
                    });
    wide.triangles = std::move(triangles);
    for (const WideBvhNode<kWidth>& node : wide.nodes) {
        for (int k = 0; k < kWidth; ++k) {
            if (node.count[k] != 0)
                wide.triangles[(node.child[k] & ~kLeafBit) + node.count[k] - 1].flags |= kLastInLeaf;
        }
    }
    return wide;
}

template WideBvh<4> make_wide_bvh(const Bvh&, const CollapseSettings&, Sink&);
template WideBvh<8> make_wide_bvh(const Bvh&, const CollapseSettings&, Sink&);

} // namespace pertev
