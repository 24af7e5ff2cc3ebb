// Top-down build by spatial median: a node is split in the middle of the longest side of the box around its
// triangles' centres. With the box around the triangles themselves a side could be empty.
//
// Source: Wald, Boulos, Shirley, "Ray Tracing Deformable Scenes using Dynamic Bounding Volume Hierarchies", ACM TOG
// 2007, section 4 (as the baseline for the surface area heuristic).

#include <algorithm>

#include "accel/builders/build_bvh.h"
#include "accel/builders/build_top_down.h"
#include "accel/builders/builders.h"
#include "accel/builders/halve_references.h"

namespace pertev {
namespace {

struct MedianCuts {
    std::vector<BuildReference> references;

    uint32_t halve(uint32_t begin, uint32_t end) {
        const std::span range(references.data() + begin, end - begin);
        return begin + halve_references(range, centres_of(range));
    }
    uint32_t cut(uint32_t begin, uint32_t end) {
        const std::span range(references.data() + begin, end - begin);
        const Bounds3 centres = centres_of(range);
        const int axis = longest_axis(centres);
        const float middle = component(centres.centre(), axis);
        const auto second = std::partition(range.begin(), range.end(), [&](const BuildReference& r) {
            return component(centre_of(r), axis) < middle;
        });
        if (second == range.begin() || second == range.end()) return begin + halve_references(range, centres);
        return begin + static_cast<uint32_t>(second - range.begin());
    }
    const BuildReference& at(uint32_t position) const { return references[position]; }
};

} // namespace

Bvh build_median_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings) {
    check_reference_count(triangles.size());
    MedianCuts cuts = {references_of(triangles)};
    return make_bvh(TopDownBuilder(cuts, static_cast<uint32_t>(triangles.size()), *settings.sink).build(), triangles,
                    settings);
}

} // namespace pertev
