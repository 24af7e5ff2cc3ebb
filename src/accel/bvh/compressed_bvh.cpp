#include "accel/bvh/compressed_bvh.h"

#include <algorithm>
#include <bit>

#include "accel/bvh/compress_boxes.h"
#include "base/error.h"
#include "base/parallel_until.h"

namespace pertev {
namespace {

Bounds3 child_box(const WideBvhNode<8>& node, int k) {
    return {{node.planes[0][k], node.planes[2][k], node.planes[4][k]},
            {node.planes[1][k], node.planes[3][k], node.planes[5][k]}};
}

constexpr uint64_t kNodesAtOnce = 256; // nodes per task

} // namespace

void set_boxes(CompressedBvhNode& node, const Bounds3 (&slots)[8]) {
    Bounds3 all;
    for (const Bounds3& box : slots) all.extend(box);
    PERTEV_CHECK(!all.is_empty());
    compress_boxes(node, all, slots);
    for (int axis = 0; axis < 3; ++axis)
        PERTEV_CHECK((node.exponents_and_inner >> (8 * axis) & 0xff) <= kMaxQuantumExponent);
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

CompressedBvh compress(const WideBvh<8>& wide, Sink& sink) {
    CompressedBvh result;
    result.bounds = wide.bounds;
    result.depth = wide.depth;
    result.sah_cost = wide.sah_cost;
    if (wide.nodes.empty()) return result;
    struct Slots {
        int child[8];
    };
    std::vector<Slots> slots(wide.nodes.size());
    parallel_until(slots.size(), kNodesAtOnce, sink, [&](uint64_t i) { assign_slots(wide.nodes[i], slots[i].child); });

    // Assigns positions to nodes and their triangles.
    std::vector<uint32_t> wide_of = {0};
    wide_of.reserve(wide.nodes.size());
    result.nodes.resize(wide.nodes.size());
    uint32_t triangles = 0;
    std::vector<uint32_t> pending = {0}; // nodes of the result
    while (!pending.empty()) {
        const uint32_t at = pending.back();
        pending.pop_back();
        sink.check_at(at);
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
    parallel_until(wide_of.size(), kNodesAtOnce, sink, [&](uint64_t i) {
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

CompressedBvh make_compressed_bvh(const Bvh& bvh, const CollapseSettings& settings, Sink& sink) {
    PERTEV_CHECK(settings.max_leaf <= kCompressedLeaf);
    return compress(make_wide_bvh<8>(bvh, settings, sink), sink);
}

} // namespace pertev
