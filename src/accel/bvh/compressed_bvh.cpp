#include "accel/bvh/compressed_bvh.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "accel/bvh/compress_boxes.h"
#include "base/error.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

Bounds3 child_box(const WideBvhNode<8>& node, int k) {
    return {{node.planes[0][k], node.planes[2][k], node.planes[4][k]},
            {node.planes[1][k], node.planes[3][k], node.planes[5][k]}};
}

constexpr uint64_t kNodesAtOnce = 256; // nodes per task

int byte_of(const uint32_t (&words)[2], int slot) { return static_cast<int>(words[slot / 4] >> 8 * (slot % 4) & 0xff); }

} // namespace

void set_boxes(CompressedBvhNode& node, const Bounds3 (&slots)[8]) {
    Bounds3 all;
    for (const Bounds3& box : slots) all.extend(box);
    PERTEV_CHECK(!all.is_empty());
    compress_boxes(node, all, slots);
    for (int axis = 0; axis < 3; ++axis)
        PERTEV_CHECK((node.exponents_and_inner >> (8 * axis) & 0xff) <= kMaxQuantumExponent);
}

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

void assign_slots(const WideBvhNode<8>& node, int (&child_of_slot)[8]) {
    Bounds3 all;
    int count = 0;
    for (; count < 8 && node.child[count] != kNoLink; ++count) all.extend(child_box(node, count));
    float costs[8][8] = {}; // [child][slot]
    for (int k = 0; k < count; ++k) {
        const Vec3 from = child_box(node, k).centre() - all.centre();
        for (int s = 0; s < 8; ++s) {
            costs[k][s] = (s & 1 ? -from.x : from.x) + (s & 2 ? -from.y : from.y) + (s & 4 ? -from.z : from.z);
        }
    }
    // Finds the cheapest assignment: least[set] is the cost of the first |set| children in these slots.
    float least[256];
    uint8_t last[256] = {};
    std::fill(least, least + 256, kInfinity);
    least[0] = 0;
    for (uint32_t set = 0; set < 256; ++set) {
        const int child = __builtin_popcount(set);
        for (int s = 0; s < 8 && child < count; ++s) {
            const uint32_t with = set | 1u << s;
            if (with == set || !(least[set] + costs[child][s] < least[with])) continue;
            least[with] = least[set] + costs[child][s];
            last[with] = static_cast<uint8_t>(s);
        }
    }
    uint32_t best = 0;
    for (uint32_t set = 0; set < 256; ++set) {
        if (__builtin_popcount(set) == count && (best == 0 || least[set] < least[best])) best = set;
    }
    std::fill(child_of_slot, child_of_slot + 8, -1);
    for (int k = count - 1; k >= 0; --k) {
        child_of_slot[last[best]] = k;
        best &= ~(1u << last[best]);
    }
}

CompressedBvhView view_of(const CompressedBvh& bvh) {
    if (bvh.nodes.empty()) return {};
    return {bvh.nodes.data(), bvh.triangles.data(), bvh.bounds.max_abs()};
}

CompressedBvh compress(const WideBvh<8>& wide) {
    CompressedBvh result;
    result.bounds = wide.bounds;
    result.depth = wide.depth;
    result.sah_cost = wide.sah_cost;
    if (wide.nodes.empty()) return result;
    struct Slots {
        int child[8];
    };
    std::vector<Slots> slots(wide.nodes.size());
    parallel_for(slots.size(), kNodesAtOnce, [&](uint64_t i) { assign_slots(wide.nodes[i], slots[i].child); });

    // Assigns positions to nodes and their triangles.
    std::vector<uint32_t> wide_of = {0};
    wide_of.reserve(wide.nodes.size());
    result.nodes.resize(wide.nodes.size());
    uint32_t triangles = 0;
    std::vector<uint32_t> pending = {0}; // nodes of the result
    while (!pending.empty()) {
        const uint32_t at = pending.back();
        pending.pop_back();
        const WideBvhNode<8>& from = wide.nodes[wide_of[at]];
        CompressedBvhNode& node = result.nodes[at];
        node.child_base = static_cast<uint32_t>(wide_of.size());
        node.triangle_base = triangles;
        for (int s = 0; s < 8; ++s) {
            const int k = slots[wide_of[at]].child[s];
            if (k < 0) continue;
            if (!(from.child[k] & kLeafBit)) {
                node.exponents_and_inner |= 1u << (24 + s);
                pending.push_back(static_cast<uint32_t>(wide_of.size()));
                wide_of.push_back(from.child[k]);
                continue;
            }
            PERTEV_CHECK(from.count[k] >= 1 && from.count[k] <= kCompressedLeaf);
            node.triangles |= (((1u << 8 * from.count[k]) - 1) & 0x010101u) << s;
            triangles += from.count[k];
        }
    }

    result.triangles.resize(triangles);
    parallel_for(wide_of.size(), kNodesAtOnce, [&](uint64_t i) {
        CompressedBvhNode& node = result.nodes[i];
        const WideBvhNode<8>& from = wide.nodes[wide_of[i]];
        const Slots& of = slots[wide_of[i]];
        Bounds3 boxes[8];
        for (int s = 0; s < 8; ++s) {
            if (of.child[s] >= 0) boxes[s] = child_box(from, of.child[s]);
        }
        set_boxes(node, boxes);
        uint32_t triangle = node.triangle_base;
        for (uint32_t left = node.triangles; left != 0; left &= left - 1) {
            const int bit = std::countr_zero(left);
            const uint32_t leaf = from.child[of.child[bit % 8]] & ~kLeafBit;
            result.triangles[triangle++] = wide.triangles[leaf + static_cast<uint32_t>(bit / 8)];
        }
    });
    return result;
}

CompressedBvh make_compressed_bvh(const Bvh& bvh, const CollapseSettings& settings) {
    PERTEV_CHECK(settings.max_leaf <= kCompressedLeaf);
    return compress(make_wide_bvh<8>(bvh, settings));
}

namespace {

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
        Bounds3 box;
        box.extend(t.a);
        box.extend(t.b);
        box.extend(t.c);
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

} // namespace

std::optional<std::string> find_fault(const CompressedBvh& bvh, bool clipped) {
    std::string fault = CompressedBvhChecker(bvh, clipped).run();
    return fault.empty() ? std::nullopt : std::optional(std::move(fault));
}

} // namespace pertev
