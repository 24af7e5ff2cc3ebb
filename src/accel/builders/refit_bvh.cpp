#include "accel/builders/refit_bvh.h"

#include <unordered_map>

#include "accel/builders/build_bvh.h"
#include "base/error.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

constexpr uint64_t kRefitGrain = 1 << 12;

/// Returns the position of each instance's first triangle.
std::unordered_map<uint32_t, std::size_t> firsts_of(const std::vector<BvhTriangle>& triangles) {
    std::unordered_map<uint32_t, std::size_t> firsts;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        if (i == 0 || triangles[i].instance != triangles[i - 1].instance) firsts.emplace(triangles[i].instance, i);
    }
    return firsts;
}

} // namespace

std::optional<std::string> why_no_refit(BvhBuilder builder) {
    if (!cuts_triangles(builder)) return std::nullopt;
    return std::string(name_of(builder)) +
           ": its boxes contain parts of triangles, which change when the triangles move; the tree is rebuilt";
}

Bvh refit_bvh(const Bvh& bvh, const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings) {
    Bvh refitted = bvh;
    if (bvh.root == kNoLink) return refitted;
    const std::unordered_map<uint32_t, std::size_t> firsts = firsts_of(triangles);
    parallel_for(refitted.triangles.size(), kRefitGrain, [&](uint64_t i) {
        BvhTriangle& t = refitted.triangles[i];
        const auto first = firsts.find(t.instance);
        const std::size_t at = first == firsts.end() ? triangles.size() : first->second + t.primitive;
        if (at >= triangles.size() || triangles[at].instance != t.instance || triangles[at].primitive != t.primitive) {
            throw Error(ErrorCode::BadInput, "a tree can only be refitted to the triangles that it was built over");
        }
        t.a = triangles[at].a, t.b = triangles[at].b, t.c = triangles[at].c;
    });

    const std::vector<BuildReference> boxes = references_of(refitted.triangles);
    const auto leaf_box = [&](uint32_t link, int& count) {
        Bounds3 box;
        count = 0;
        for (uint32_t i = link & ~kLeafBit;; ++i) {
            box.extend(Bounds3{boxes[i].lo, boxes[i].hi});
            ++count;
            if (refitted.triangles[i].flags & kLastInLeaf) return box;
        }
    };
    int count = 0;
    if (bvh.root & kLeafBit) {
        refitted.bounds = leaf_box(bvh.root, count);
        refitted.sah_cost = settings.leaf_cost * static_cast<float>(count);
        return refitted;
    }
    std::vector<BvhNode>& nodes = refitted.nodes;
    std::vector<float> leaf_cost(nodes.size()); // [node] cost of its leaves
    parallel_for(nodes.size(), kRefitGrain, [&](uint64_t i) {
        for (int k = 0; k < 2; ++k) {
            if ((nodes[i].child[k] & kLeafBit) == 0) continue;
            int held = 0;
            const Bounds3 box = leaf_box(nodes[i].child[k], held);
            set_child(nodes[i], k, box, nodes[i].child[k]);
            leaf_cost[i] += settings.leaf_cost * static_cast<float>(held) * box.half_area();
        }
    });
    double cost = 0;
    for (std::size_t i = nodes.size(); i-- > 0;) { // reverse depth-first order: children come before their parents
        for (int k = 0; k < 2; ++k) {
            const uint32_t link = nodes[i].child[k];
            if (link & kLeafBit) continue;
            Bounds3 box = child_bounds(nodes[link], 0);
            box.extend(child_bounds(nodes[link], 1));
            set_child(nodes[i], k, box, link);
        }
        Bounds3 whole = child_bounds(nodes[i], 0);
        whole.extend(child_bounds(nodes[i], 1));
        cost += static_cast<double>(settings.node_cost * whole.half_area() + leaf_cost[i]);
        if (i == bvh.root) refitted.bounds = whole;
    }
    refitted.sah_cost = static_cast<float>(cost / static_cast<double>(max(refitted.bounds.half_area(), 0x1p-126f)));
    return refitted;
}

} // namespace pertev
