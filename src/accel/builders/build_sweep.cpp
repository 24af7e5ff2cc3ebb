// Top-down build by the exact surface area heuristic: every split between neighbours along every axis is tried.
//
// Source: Wald, Boulos, Shirley, "Ray Tracing Deformable Scenes using Dynamic Bounding Volume Hierarchies", ACM TOG
// 2007, algorithm 1; sorted once, and kept sorted by stable partitions, as in Wald, Havran, "On building fast kd-Trees
// for Ray Tracing, and on doing that in O(N log N)", IEEE RT 2006, section 4.3.

#include <algorithm>

#include "accel/builders/build_bvh.h"
#include "accel/builders/build_top_down.h"
#include "accel/builders/builders.h"
#include "accel/builders/halve_references.h"
#include "accel/builders/sweep_cut.h"
#include "base/sort_until.h"

namespace pertev {
namespace {

constexpr uint32_t kParallelAxes = 1u << 14; // from this many references on, the three axes are processed in parallel

template <class Body>
void for_each_axis(uint32_t size, const Body& body) {
    if (size < kParallelAxes) {
        for (int axis = 0; axis < 3; ++axis) body(axis);
    } else {
        parallel_for(3, 1, [&](uint64_t axis) { body(static_cast<int>(axis)); });
    }
}

class SweepCuts {
public:
    SweepCuts(const std::vector<BvhTriangle>& triangles, Sink& sink) : sink_(sink) {
        const std::vector<BuildReference> references = references_of(triangles);
        for_each_axis(static_cast<uint32_t>(references.size()), [&](int axis) {
            sorted_[axis] = references;
            sort_until(std::span(sorted_[axis]), sink,
                       [axis](const BuildReference& a, const BuildReference& b) { return lies_before(a, b, axis); });
            right_area_[axis].resize(references.size());
        });
    }

    uint32_t cut(uint32_t begin, uint32_t end) {
        SweepCut cuts[3];
        for_each_axis(end - begin, [&](int axis) {
            const BuildReference* sorted = sorted_[axis].data() + begin;
            const auto box_at = [sorted](uint32_t i) { return Bounds3{sorted[i].lo, sorted[i].hi}; };
            cuts[axis] = find_sweep_cut(end - begin, box_at, right_area_[axis].data() + begin);
        });
        int best = 0;
        for (int axis = 1; axis < 3; ++axis) best = cuts[axis].cost < cuts[best].cost ? axis : best;
        if (!cuts[best].gains()) return halve(begin, end);
        split(begin, end, best, begin + cuts[best].left);
        return begin + cuts[best].left;
    }

    uint32_t halve(uint32_t begin, uint32_t end) {
        const int axis = longest_axis(centres_of({sorted_[0].data() + begin, end - begin}));
        const uint32_t middle = begin + (end - begin) / 2;
        split(begin, end, axis, middle);
        return middle;
    }

    const BuildReference& at(uint32_t position) const { return sorted_[0][position]; }

private:
    /// Moves the references before `middle` along `axis` to the front in the two other orders, which stay sorted in
    /// both halves.
    void split(uint32_t begin, uint32_t end, int axis, uint32_t middle) {
        const BuildReference first_right = sorted_[axis][middle];
        for_each_axis(end - begin, [&](int other) {
            if (other == axis) return;
            if (end - begin >= kParallelAxes) sink_.check();
            std::vector<BuildReference>& sorted = sorted_[other];
            std::vector<BuildReference> right;
            right.reserve(end - middle);
            uint32_t left = begin;
            for (uint32_t i = begin; i < end; ++i) {
                if (lies_before(sorted[i], first_right, axis)) {
                    sorted[left++] = sorted[i];
                } else {
                    right.push_back(sorted[i]);
                }
            }
            std::copy(right.begin(), right.end(), sorted.begin() + left);
        });
    }

    Sink& sink_;
    std::vector<BuildReference> sorted_[3]; // [axis] sorted along it within each range that is not split yet
    std::vector<float> right_area_[3];      // scratch memory for find_sweep_cut
};

} // namespace

Bvh build_sweep_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings) {
    check_reference_count(triangles.size());
    SweepCuts cuts(triangles, *settings.sink);
    return make_bvh(TopDownBuilder(cuts, static_cast<uint32_t>(triangles.size()), *settings.sink).build(), triangles,
                    settings);
}

} // namespace pertev
