#include "accel/bvh/parent_links.h"

#include "base/parallel_until.h"

namespace pertev {
namespace {

constexpr uint64_t kParentGrain = 1 << 14;

uint32_t split_of(const BvhNode& node) {
    const Vec3 apart = child_bounds(node, 1).centre() - child_bounds(node, 0).centre();
    const Vec3 size = abs(apart);
    const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    return static_cast<uint32_t>(axis) | (component(apart, axis) < 0 ? kSecondIsLower : 0u);
}

} // namespace

void add_parent_links(Bvh& bvh, Sink& sink) {
    if (bvh.root & kLeafBit) return;
    bvh.nodes[bvh.root].parent = kNoLink;
    parallel_until(bvh.nodes.size(), kParentGrain, sink, [&](uint64_t i) {
        BvhNode& node = bvh.nodes[i];
        node.split = split_of(node);
        for (uint32_t k = 0; k < 2; ++k) { // only the one parent of a node writes to it
            if (node.child[k] & kLeafBit) continue;
            bvh.nodes[node.child[k]].parent = static_cast<uint32_t>(i) | (k == 1 ? kSecondChildBit : 0u);
        }
    });
}

} // namespace pertev
