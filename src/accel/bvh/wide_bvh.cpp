#include "accel/bvh/wide_bvh.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/limits.h"

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
WideBvh<kWidth> assemble(const Bvh& bvh, const CollapseSettings& settings) {
    const CollapsedTree tree(bvh, settings, kWidth);
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
        throw Error(ErrorCode::OverLimit, fmt::format("a tree of {} children a node is {} levels deep, {} are allowed",
                                                      kWidth, wide.depth, kMaxBvhDepth));
    }
    const float area = bvh.bounds.half_area();
    wide.sah_cost = area > 0 ? static_cast<float>(cost / static_cast<double>(area)) : 0;
    return wide;
}

bool wide_holds(const Bounds3& box, Vec3 p) {
    return box.lo.x <= p.x && p.x <= box.hi.x && box.lo.y <= p.y && p.y <= box.hi.y && box.lo.z <= p.z &&
           p.z <= box.hi.z;
}
bool wide_holds(const Bounds3& box, const Bounds3& inner) {
    return wide_holds(box, inner.lo) && wide_holds(box, inner.hi);
}

Bounds3 box_of(const BvhTriangle& t) {
    Bounds3 box;
    box.extend(t.a);
    box.extend(t.b);
    box.extend(t.c);
    return box;
}

bool meet(const Bounds3& a, const Bounds3& b) { return !Bounds3{max(a.lo, b.lo), min(a.hi, b.hi)}.is_empty(); }

template <int kWidth>
class WideBvhChecker {
public:
    WideBvhChecker(const WideBvh<kWidth>& bvh, bool clipped) : bvh_(bvh), clipped_(clipped) {}

    std::string run() {
        node_seen_.resize(bvh_.nodes.size());
        triangle_seen_.resize(bvh_.triangles.size());
        std::vector<Pending> pending;
        if (!bvh_.nodes.empty()) pending.push_back({0, 1, bvh_.bounds});
        std::size_t nodes = 0;
        int depth = 0;
        for (; !pending.empty(); ++nodes) {
            const Pending at = pending.back();
            pending.pop_back();
            if (at.node >= bvh_.nodes.size()) return fmt::format("a link to node {} of {}", at.node, node_seen_.size());
            if (node_seen_[at.node]) return fmt::format("node {} is reached twice", at.node);
            node_seen_[at.node] = true;
            depth = max(depth, at.depth);
            std::string fault = check_children(at, pending);
            if (!fault.empty()) return fmt::format("node {}: {}", at.node, fault);
        }
        if (nodes != bvh_.nodes.size()) return fmt::format("{} of {} nodes are reached", nodes, bvh_.nodes.size());
        if (triangles_ != bvh_.triangles.size()) {
            return fmt::format("{} of {} triangles are reached", triangles_, bvh_.triangles.size());
        }
        if (depth != bvh_.depth || depth > kMaxBvhDepth) return fmt::format("depth {}, stated {}", depth, bvh_.depth);
        return {};
    }

private:
    struct Pending {
        uint32_t node;
        int depth;
        Bounds3 box;
    };

    std::string check_children(const Pending& at, std::vector<Pending>& pending) {
        const WideBvhNode<kWidth>& node = bvh_.nodes[at.node];
        bool ended = false;
        for (int k = 0; k < kWidth; ++k) {
            const Bounds3 box = child_bounds(node, k);
            if (node.child[k] == kNoLink) {
                if (!box.is_empty()) return fmt::format("place {} is empty but has a box", k);
                ended = true;
                continue;
            }
            if (ended) return fmt::format("child {} stands after an empty place", k);
            if (!wide_holds(at.box, box)) return fmt::format("child {} is outside it", k);
            if (!(node.child[k] & kLeafBit)) {
                pending.push_back({node.child[k], at.depth + 1, box});
                continue;
            }
            std::string fault = check_leaf(node.child[k] & ~kLeafBit, node.count[k], box);
            if (!fault.empty()) return fault;
        }
        return {};
    }

    std::string check_leaf(uint64_t first, uint64_t count, const Bounds3& box) {
        if (count == 0) return "a leaf without triangles";
        if (first + count > bvh_.triangles.size()) return fmt::format("a leaf runs past triangle {}", first);
        for (uint64_t i = first; i < first + count; ++i) {
            if (triangle_seen_[i]) return fmt::format("triangle {} is reached twice", i);
            triangle_seen_[i] = true;
            const BvhTriangle& t = bvh_.triangles[i];
            const Bounds3 of_triangle = box_of(t);
            if (clipped_ ? !meet(box, of_triangle) : !wide_holds(box, of_triangle)) {
                return fmt::format("triangle {} is outside its leaf", i);
            }
            if (((t.flags & kLastInLeaf) != 0) != (i + 1 == first + count)) {
                return fmt::format("triangle {} says wrongly whether its leaf ends", i);
            }
        }
        triangles_ += count;
        return {};
    }

    const WideBvh<kWidth>& bvh_;
    const bool clipped_;
    std::vector<bool> node_seen_, triangle_seen_;
    uint64_t triangles_ = 0;
};

} // namespace

template <int kWidth>
WideBvh<kWidth> make_wide_bvh(const Bvh& bvh, const CollapseSettings& settings) {
    WideBvh<kWidth> wide = assemble<kWidth>(bvh, settings);
    wide.triangles = bvh.triangles;
    for (BvhTriangle& t : wide.triangles) t.flags &= ~kLastInLeaf;
    for (const WideBvhNode<kWidth>& node : wide.nodes) {
        for (int k = 0; k < kWidth; ++k) {
            if (node.count[k] != 0)
                wide.triangles[(node.child[k] & ~kLeafBit) + node.count[k] - 1].flags |= kLastInLeaf;
        }
    }
    return wide;
}

template <int kWidth>
std::optional<std::string> find_fault(const WideBvh<kWidth>& bvh, bool clipped) {
    std::string fault = WideBvhChecker<kWidth>(bvh, clipped).run();
    return fault.empty() ? std::nullopt : std::optional(std::move(fault));
}

template WideBvh<4> make_wide_bvh(const Bvh&, const CollapseSettings&);
template WideBvh<8> make_wide_bvh(const Bvh&, const CollapseSettings&);
template std::optional<std::string> find_fault(const WideBvh<4>&, bool);
template std::optional<std::string> find_fault(const WideBvh<8>&, bool);

} // namespace pertev
