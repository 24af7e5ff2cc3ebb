// Top down, and where halves would overlap, triangles are cut: each half gets a reference to them, with the box of its
// part. Exact cuts between triangles, binned cuts through them.
//
// Source: Stich, Friedrich, Dietrich, "Spatial Splits in Bounding Volume Hierarchies", HPG 2009. Ours: every subtree
// has an allowance of references to add, which its parent shares out, so that the sum is bounded and threads do not
// matter.

#include <algorithm>
#include <atomic>

#include "accel/bvh/binary_tree.h"
#include "accel/bvh/build_bvh.h"
#include "accel/bvh/builders.h"
#include "accel/bvh/cut_triangle.h"
#include "accel/bvh/find_spatial_cut.h"
#include "accel/bvh/halve_references.h"
#include "accel/bvh/sweep_cut.h"
#include "base/error.h"
#include "base/limits.h"
#include "base/parallel_for.h"

namespace pertev {
namespace {

constexpr uint32_t kParallelSubtree = 1u << 12; // references from which the two halves are built at once
constexpr uint32_t kParallelAxes = 1u << 14;    // references from which the three axes are seen to at once

using References = std::vector<BuildReference>;

Bounds3 box_of(const BuildReference& r) { return {r.lo, r.hi}; }

Bounds3 box_of_all(const References& references) {
    Bounds3 box;
    for (const BuildReference& r : references) box.extend(box_of(r));
    return box;
}

/// Centre and position in one number that sorts like the two.
uint64_t sort_key(float centre, std::size_t position) {
    const uint32_t bits = bits_of(centre);
    const uint32_t ordered = bits & 0x80000000u ? ~bits : bits | 0x80000000u;
    return static_cast<uint64_t>(ordered) << 32 | position;
}

class SpatialSplitBuilder {
public:
    SpatialSplitBuilder(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings,
                        const SpatialSplitSettings& splits)
        : triangles_(triangles), settings_(settings), splits_(splits) {}

    BinaryTree build() {
        References all = references_of(triangles_);
        const auto allowance =
            static_cast<uint64_t>(static_cast<double>(splits_.max_growth) * static_cast<double>(all.size()));
        check_reference_count(all.size() + allowance);
        tree_.nodes.resize(2 * (all.size() + allowance) - 1);
        tree_.references.resize(all.size() + allowance);
        min_overlap_ = splits_.min_overlap * box_of_all(all).half_area();
        tree_.root = build_node(std::move(all), allowance, 0);
        return std::move(tree_);
    }

private:
    struct Halves {
        References left, right;
    };

    uint32_t build_node(References references, uint64_t allowance, int depth) {
        // Which node is where depends on threads; what links to what does not, and nothing else is asked.
        const uint32_t index = nodes_++;
        if (references.size() == 1) {
            const uint32_t position = leaves_++;
            tree_.references[position] = references[0].id;
            tree_.nodes[index] = make_leaf(box_of(references[0]), position);
            return index;
        }
        const std::size_t before = references.size();
        Halves halves = cut(references, allowance, kMaxBvhDepth - depth);
        References().swap(references); // both halves' and all parents' copies would add up
        const uint64_t left_size = halves.left.size(), right_size = halves.right.size();
        const uint64_t left_over = allowance - (left_size + right_size - before);
        const double left_need = need(halves.left), right_need = need(halves.right), both = left_need + right_need;
        const double left_part = both > 0 ? left_need / both : 0.5;
        const auto left_allowance = static_cast<uint64_t>(left_part * static_cast<double>(left_over));
        uint32_t left = 0, right = 0;
        const auto build_left = [&] { left = build_node(std::move(halves.left), left_allowance, depth + 1); };
        const auto build_right = [&] {
            right = build_node(std::move(halves.right), left_over - left_allowance, depth + 1);
        };
        if (before >= kParallelSubtree) {
            parallel_invoke(build_left, build_right);
        } else {
            build_left();
            build_right();
        }
        tree_.nodes[index] = make_inner(tree_, left, right);
        return index;
    }

    /// What a half's part of the allowance goes by. By count, small triangles would get what large ones can use: in
    /// Sponza the tree then costs 3 % more.
    static double need(const References& references) {
        double sum = 0;
        for (const BuildReference& r : references) sum += static_cast<double>(box_of(r).half_area());
        return sum;
    }

    Halves cut(References& references, uint64_t allowance, int levels_left) const {
        const auto count = static_cast<uint32_t>(references.size());
        std::vector<uint64_t> order[3];
        SweepCut cuts[3];
        if (levels_needed(count) >= levels_left) return halve(references);
        for_each_axis(count, [&](int axis) { cuts[axis] = find_cut(references, axis, order[axis]); });
        int best = 0;
        for (int axis = 1; axis < 3; ++axis) best = cuts[axis].cost < cuts[best].cost ? axis : best;

        const bool may_cut_triangles = allowance > 0 && count > static_cast<uint32_t>(settings_.max_leaf);
        if (may_cut_triangles && overlap(references, order[best], cuts[best].left) > min_overlap_) {
            SpatialCut cut[3];
            const Bounds3 box = box_of_all(references);
            for_each_axis(
                count, [&](int axis) { cut[axis] = find_spatial_cut(references, triangles_, box, axis, allowance); });
            int axis = 0;
            for (int k = 1; k < 3; ++k) axis = cut[k].cost < cut[axis].cost ? k : axis;
            if (cut[axis].cost < min(cuts[best].cost, cuts[best].uncut)) {
                Halves halves = cut_triangles(references, cut[axis], axis);
                // What bins foresee and cutting gives may differ by rounding.
                const std::size_t sum = halves.left.size() + halves.right.size();
                if (!halves.left.empty() && !halves.right.empty() && sum - count <= allowance) return halves;
            }
        }
        if (!cuts[best].gains()) return halve(references);
        Halves halves;
        for (uint32_t i = 0; i < count; ++i) {
            const BuildReference& reference = references[static_cast<uint32_t>(order[best][i])];
            (i < cuts[best].left ? halves.left : halves.right).push_back(reference);
        }
        return halves;
    }

    template <class Body>
    static void for_each_axis(uint32_t size, const Body& body) {
        if (size >= kParallelAxes) return parallel_for(3, 1, [&](uint64_t axis) { body(static_cast<int>(axis)); });
        for (int axis = 0; axis < 3; ++axis) body(axis);
    }

    static SweepCut find_cut(const References& references, int axis, std::vector<uint64_t>& order) {
        order.resize(references.size());
        for (std::size_t i = 0; i < order.size(); ++i) {
            order[i] = sort_key(component(centre_of(references[i]), axis), i);
        }
        std::sort(order.begin(), order.end());
        std::vector<float> right_area(order.size());
        const auto box_at = [&](uint32_t i) { return box_of(references[static_cast<uint32_t>(order[i])]); };
        return find_sweep_cut(static_cast<uint32_t>(order.size()), box_at, right_area.data());
    }

    static float overlap(const References& references, const std::vector<uint64_t>& order, uint32_t left_size) {
        Bounds3 left, right;
        for (uint32_t i = 0; i < order.size(); ++i) {
            (i < left_size ? left : right).extend(box_of(references[static_cast<uint32_t>(order[i])]));
        }
        return intersection(left, right).half_area();
    }

    static Halves halve(References& references) {
        const auto middle = static_cast<std::ptrdiff_t>(halve_references(references, centres_of(references)));
        return {{references.begin(), references.begin() + middle}, {references.begin() + middle, references.end()}};
    }

    /// A triangle that the plane cuts goes to both sides, or to one where that costs less ("reference unsplitting").
    Halves cut_triangles(const References& references, SpatialCut cut, int axis) const {
        Halves halves;
        const auto put = [](References& side, const BuildReference& r, const Bounds3& box) {
            side.push_back({box.lo, r.id, box.hi});
        };
        for (const BuildReference& r : references) {
            const Bounds3 box = box_of(r);
            ClippedBoxes parts;
            if (component(box.hi, axis) > cut.plane && component(box.lo, axis) < cut.plane) {
                parts = cut_triangle(triangles_[r.id], box, axis, cut.plane);
                if (parts.left.is_empty() && parts.right.is_empty()) parts.left = box; // never: it has a point there
            } else {
                (component(box.hi, axis) <= cut.plane ? parts.left : parts.right) = box;
            }
            if (!parts.left.is_empty() && !parts.right.is_empty()) {
                const auto area_with = [&](const Bounds3& side) {
                    Bounds3 both = side;
                    both.extend(box);
                    return both.half_area();
                };
                const float left = cut.left.half_area(), right = cut.right.half_area();
                const auto nl = static_cast<float>(cut.left_size), nr = static_cast<float>(cut.right_size);
                const float to_both = left * nl + right * nr;
                const float to_left = area_with(cut.left) * nl + right * (nr - 1);
                const float to_right = left * (nl - 1) + area_with(cut.right) * nr;
                if (min(to_left, to_right) < to_both) {
                    const bool goes_left = to_left <= to_right;
                    (goes_left ? parts.left : parts.right) = box;
                    (goes_left ? parts.right : parts.left) = {};
                    (goes_left ? cut.left : cut.right).extend(box);
                    --(goes_left ? cut.right_size : cut.left_size);
                }
            }
            if (!parts.left.is_empty()) put(halves.left, r, parts.left);
            if (!parts.right.is_empty()) put(halves.right, r, parts.right);
        }
        return halves;
    }

    const std::vector<BvhTriangle>& triangles_;
    const BvhBuildSettings& settings_;
    const SpatialSplitSettings& splits_;
    float min_overlap_ = 0;
    BinaryTree tree_;
    std::atomic<uint32_t> nodes_{0}, leaves_{0};
};

} // namespace

Bvh build_spatial_split_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings,
                            const SpatialSplitSettings& splits) {
    PERTEV_CHECK(splits.min_overlap >= 0 && splits.max_growth >= 0 && splits.max_growth <= 1000);
    if (triangles.empty()) return {};
    return make_bvh(SpatialSplitBuilder(triangles, settings, splits).build(), triangles, settings);
}

} // namespace pertev
