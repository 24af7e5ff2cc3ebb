#include "tests/support/check_wide_bvh.h"

#include <bit>
#include <vector>

#include <fmt/format.h>

#include "accel/bvh/compress_boxes.h"
#include "base/limits.h"
#include "tests/support/check_cells.h"

namespace pertev {
namespace {

template <int kWidth>
Bounds3 wide_child_bounds(const WideBvhNode<kWidth>& node, int k) {
    return {{node.planes[0][k], node.planes[2][k], node.planes[4][k]},
            {node.planes[1][k], node.planes[3][k], node.planes[5][k]}};
}

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
            const Bounds3 box = wide_child_bounds(node, k);
            if (node.child[k] == kNoLink) {
                if (!box.is_empty()) return fmt::format("place {} is empty but has a box", k);
                ended = true;
                continue;
            }
            if (ended) return fmt::format("child {} stands after an empty place", k);
            if (!holds(at.box, box)) return fmt::format("child {} is outside it", k);
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
            const Bounds3 of_triangle = bounds_of(t);
            if (clipped_ ? Bounds3{max(box.lo, of_triangle.lo), min(box.hi, of_triangle.hi)}.is_empty()
                         : !holds(box, of_triangle)) {
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

int byte_of(const uint32_t (&words)[2], int slot) { return static_cast<int>(words[slot / 4] >> 8 * (slot % 4) & 0xff); }

class CompressedBvhChecker {
public:
    CompressedBvhChecker(const CompressedBvh& bvh, bool clipped) : bvh_(bvh), clipped_(clipped) {}

    std::string run() {
        node_seen_.resize(bvh_.nodes.size());
        triangle_seen_.resize(bvh_.triangles.size());
        if (!bvh_.nodes.empty()) ways_.push_back({0, -1, 0, 1});
        int depth = 0;
        for (std::size_t at = 0; at < ways_.size(); ++at) {
            const uint32_t node = ways_[at].node;
            if (node >= bvh_.nodes.size()) return fmt::format("a link to node {} of {}", node, bvh_.nodes.size());
            if (node_seen_[node]) return fmt::format("node {} is reached twice", node);
            node_seen_[node] = true;
            depth = max(depth, ways_[at].depth);
            std::string fault = check_node(static_cast<int>(at));
            if (!fault.empty()) return fmt::format("node {}: {}", node, fault);
        }
        if (ways_.size() != bvh_.nodes.size()) return fmt::format("only {} nodes are reached", ways_.size());
        if (triangles_ != bvh_.triangles.size()) return fmt::format("only {} triangles are reached", triangles_);
        if (depth != bvh_.depth || depth > kMaxBvhDepth) return fmt::format("depth {}, stated {}", depth, bvh_.depth);
        return {};
    }

private:
    /// A node and its path from the root: the index of its parent's entry, and its slot there.
    struct Way {
        uint32_t node;
        int parent, slot, depth;
    };

    std::string check_node(int at) {
        const CompressedBvhNode node = bvh_.nodes[ways_[static_cast<std::size_t>(at)].node];
        for (int axis = 0; axis < 3; ++axis) {
            const uint32_t exponent = node.exponents_and_inner >> 8 * axis & 0xff;
            if (exponent < kMinQuantumExponent || exponent > kMaxQuantumExponent) return "its grid is out of range";
        }
        if (node.byte_base != kByteBase) return "its bytes have another base";
        if (node.triangles >> 24 != 0) return "its leaves are too large";
        uint32_t child = node.child_base;
        for (int slot = 0; slot < 8; ++slot) {
            const uint32_t run = node.triangles >> slot & 0x010101u;
            if (run != 0 && run != 1 && run != 0x0101 && run != 0x010101)
                return fmt::format("slot {} counts wrongly", slot);
            if (inner_slots(node) >> slot & 1) {
                if (run != 0) return fmt::format("slot {} is a leaf and a node", slot);
                ways_.push_back({child++, at, slot, ways_[static_cast<std::size_t>(at)].depth + 1});
            }
        }
        uint64_t triangle = node.triangle_base;
        for (uint32_t left = node.triangles; left != 0; left &= left - 1) {
            std::string fault = check_triangle(triangle++, at, std::countr_zero(left) % 8);
            if (!fault.empty()) return fault;
        }
        return {};
    }

    std::string check_triangle(uint64_t index, int at, int slot) {
        if (index >= bvh_.triangles.size()) return fmt::format("a leaf runs past triangle {}", index);
        if (triangle_seen_[index]) return fmt::format("triangle {} is reached twice", index);
        triangle_seen_[index] = true;
        ++triangles_;
        const BvhTriangle& t = bvh_.triangles[index];
        const Bounds3 box = bounds_of(t);
        while (at >= 0) {
            const Way& way = ways_[static_cast<std::size_t>(at)];
            const CompressedBvhNode& node = bvh_.nodes[way.node];
            if (clipped_ ? !may_meet(node, slot, box) : !holds(node, slot, box)) {
                return fmt::format("triangle {} is outside slot {} of node {}", index, slot, way.node);
            }
            slot = way.slot;
            at = way.parent;
        }
        return {};
    }

    /// Returns whether a decoded box may overlap `box`, in double, which suffices to detect a box in the wrong
    /// position.
    static bool may_meet(const CompressedBvhNode& node, int slot, const Bounds3& box) {
        for (int axis = 0; axis < 3; ++axis) {
            const double step = static_cast<double>(quantum(node, axis));
            const double origin = static_cast<double>(node.origin[axis]) + kCorner * step;
            if (origin + byte_of(node.planes[2 * axis], slot) * step > static_cast<double>(component(box.hi, axis)) ||
                origin + byte_of(node.planes[2 * axis + 1], slot) * step < static_cast<double>(component(box.lo, axis)))
                return false;
        }
        return true;
    }

    const CompressedBvh& bvh_;
    const bool clipped_;
    std::vector<Way> ways_;
    std::vector<bool> node_seen_, triangle_seen_;
    uint64_t triangles_ = 0;
};

/// Checks the leaf at node i and marks its triangles as seen. Returns the fault, if any.
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
        if (boxes_hold_triangles && !holds({node.lo, node.hi}, bounds_of(t))) {
            return fmt::format("triangle {} is outside its leaf {}", k, i);
        }
        if (t.flags & kLastInLeaf) return std::nullopt;
    }
}

} // namespace

template <int kWidth>
std::optional<std::string> find_fault(const WideBvh<kWidth>& bvh, bool clipped) {
    std::string fault = WideBvhChecker<kWidth>(bvh, clipped).run();
    return fault.empty() ? std::nullopt : std::optional(std::move(fault));
}

template std::optional<std::string> find_fault(const WideBvh<4>&, bool);
template std::optional<std::string> find_fault(const WideBvh<8>&, bool);

bool holds(const CompressedBvhNode& node, int slot, const Bounds3& box) {
    for (int axis = 0; axis < 3; ++axis) {
        const double scale = 1 / static_cast<double>(quantum(node, axis));
        const double lower = byte_of(node.planes[2 * axis], slot), upper = byte_of(node.planes[2 * axis + 1], slot);
        const Difference lo = quanta_from_corner(component(box.lo, axis), node.origin[axis], scale);
        const Difference hi = quanta_from_corner(component(box.hi, axis), node.origin[axis], scale);
        if (lower > lo.value || (lower == lo.value && lo.rest < 0)) return false;
        if (upper < hi.value || (upper == hi.value && hi.rest > 0)) return false;
    }
    return true;
}

std::optional<std::string> find_fault(const CompressedBvh& bvh, bool clipped) {
    std::string fault = CompressedBvhChecker(bvh, clipped).run();
    return fault.empty() ? std::nullopt : std::optional(std::move(fault));
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
        if (!open.empty() && !holds({bvh.nodes[open.back()].lo, bvh.nodes[open.back()].hi}, {node.lo, node.hi})) {
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
