#include "tests/support/split_bvh.h"

#include <algorithm>
#include <cstdint>

namespace pertev::test {
namespace {

class Builder {
public:
    Builder(const std::vector<BvhTriangle>& triangles, int max_depth) : triangles_(triangles), max_depth_(max_depth) {}

    Bvh run() {
        if (triangles_.empty()) return {};
        std::vector<uint32_t> all;
        for (uint32_t i = 0; i < triangles_.size(); ++i) {
            all.push_back(i);
            bvh_.bounds.extend(bounds_of(i));
        }
        bvh_.root = build(bvh_.bounds, all, 0);
        return std::move(bvh_);
    }

private:
    Bounds3 bounds_of(uint32_t i) const {
        Bounds3 box;
        for (const Vec3 p : {triangles_[i].a, triangles_[i].b, triangles_[i].c}) box.extend(p);
        return box;
    }

    uint32_t make_leaf(const std::vector<uint32_t>& inside) {
        const auto first = static_cast<uint32_t>(bvh_.triangles.size());
        for (const uint32_t i : inside) {
            bvh_.triangles.push_back(triangles_[i]);
            bvh_.triangles.back().flags = i == inside.back() ? kLastInLeaf : 0;
        }
        return kLeafBit | first;
    }

    uint32_t build(const Bounds3& cell, const std::vector<uint32_t>& inside, int depth) {
        if (inside.size() <= 4 || depth == max_depth_) return make_leaf(inside);
        const Vec3 size = cell.size();
        const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
        const float middle = component(cell.centre(), axis);
        Bounds3 halves[2] = {cell, cell};
        (&halves[0].hi.x)[axis] = middle;
        (&halves[1].lo.x)[axis] = middle;
        std::vector<uint32_t> parts[2];
        for (const uint32_t i : inside) {
            const Bounds3 box = bounds_of(i);
            if (component(box.lo, axis) <= middle) parts[0].push_back(i);
            if (component(box.hi, axis) >= middle) parts[1].push_back(i);
        }
        for (int k = 0; k < 2; ++k) { // an empty half is removed
            if (parts[k].empty()) return build(halves[1 - k], parts[1 - k], depth + 1);
        }
        const auto index = static_cast<uint32_t>(bvh_.nodes.size());
        bvh_.nodes.emplace_back();
        bvh_.depth = std::max(bvh_.depth, depth + 1);
        for (int k = 0; k < 2; ++k) {
            const uint32_t link = build(halves[k], parts[k], depth + 1);
            set_child(bvh_.nodes[index], k, halves[k], link);
        }
        return index;
    }

    const std::vector<BvhTriangle>& triangles_;
    const int max_depth_;
    Bvh bvh_;
};

} // namespace

Bvh build_split_bvh(const std::vector<BvhTriangle>& triangles, int max_depth) {
    return Builder(triangles, max_depth).run();
}

} // namespace pertev::test
