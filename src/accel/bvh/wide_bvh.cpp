#include "accel/bvh/wide_bvh.h"

#include <algorithm>

namespace pertev {
namespace {

struct Child {
    uint32_t link;
    Bounds3 box;
    float area;
};

class Widener {
public:
    explicit Widener(const Bvh& bvh) : bvh_(bvh) {}

    std::vector<WideBvhNode> run() {
        if (bvh_.root & kLeafBit) return {};
        wide_.reserve(bvh_.nodes.size() / 4 + 1);
        struct Pending {
            uint32_t link, parent;
            int k;
        };
        std::vector<Pending> pending = {{bvh_.root, kNoLink, 0}};
        while (!pending.empty()) {
            const Pending at = pending.back();
            pending.pop_back();
            const auto index = static_cast<uint32_t>(wide_.size());
            if (at.parent != kNoLink) wide_[at.parent].child[at.k] = index;
            const WideBvhNode& node = wide_.emplace_back(make_node(at.link));
            for (int k = kWideChildren - 1; k >= 0; --k) {
                if (!(node.child[k] & kLeafBit)) pending.push_back({node.child[k], index, k});
            }
        }
        return std::move(wide_);
    }

private:
    Child child_of(uint32_t node, int k) const {
        const Bounds3 box = child_bounds(bvh_.nodes[node], k);
        return {bvh_.nodes[node].child[k], box, box.half_area()};
    }

    uint32_t leaf_size(uint32_t link) const {
        uint32_t count = 1;
        for (uint32_t i = link & ~kLeafBit; !(bvh_.triangles[i].flags & kLastInLeaf); ++i) ++count;
        return count;
    }

    /// Inner children still name binary nodes.
    WideBvhNode make_node(uint32_t root) const {
        Child children[kWideChildren] = {child_of(root, 0), child_of(root, 1)};
        int count = 2;
        while (count < kWideChildren) {
            int largest = -1;
            for (int k = 0; k < count; ++k) {
                if (children[k].link & kLeafBit) continue;
                if (largest < 0 || children[k].area > children[largest].area) largest = k;
            }
            if (largest < 0) break;
            const uint32_t opened = children[largest].link;
            // In the binary tree's order, which searches for any hit rely on.
            std::move_backward(children + largest + 1, children + count, children + count + 1);
            children[largest] = child_of(opened, 0);
            children[largest + 1] = child_of(opened, 1);
            ++count;
        }
        WideBvhNode node;
        for (int k = 0; k < kWideChildren; ++k) {
            const Bounds3 box = k < count ? children[k].box : Bounds3{};
            const float planes[6] = {box.lo.x, box.hi.x, box.lo.y, box.hi.y, box.lo.z, box.hi.z};
            for (int p = 0; p < 6; ++p) node.planes[p][k] = planes[p];
            node.child[k] = k < count ? children[k].link : kNoLink;
            node.count[k] = k < count && (children[k].link & kLeafBit) ? leaf_size(children[k].link) : 0;
        }
        return node;
    }

    const Bvh& bvh_;
    std::vector<WideBvhNode> wide_;
};

} // namespace

std::vector<WideBvhNode> make_wide_nodes(const Bvh& bvh) { return Widener(bvh).run(); }

} // namespace pertev
