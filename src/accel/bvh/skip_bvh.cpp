#include "accel/bvh/skip_bvh.h"

#include <fmt/format.h>

#include "base/error.h"

namespace pertev {

SkipBvh make_skip_bvh(const Bvh& bvh, Sink& sink) {
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
    for (uint64_t visits = 0; !pending.empty(); ++visits) {
        sink.check_at(visits);
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

} // namespace pertev
