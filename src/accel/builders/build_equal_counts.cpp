// Top-down build by object medians: the flattest possible tree, which does not adapt to empty space.
//
// Source: Kay, Kajiya, "Ray Tracing Complex Scenes", SIGGRAPH 1986, section 3 (sorted by centre, cut in the middle).

#include "accel/builders/build_bvh.h"
#include "accel/builders/build_top_down.h"
#include "accel/builders/builders.h"
#include "accel/builders/halve_references.h"

namespace pertev {
namespace {

struct EqualCountCuts {
    std::vector<BuildReference> references;

    uint32_t halve(uint32_t begin, uint32_t end) {
        const std::span range(references.data() + begin, end - begin);
        return begin + halve_references(range, centres_of(range));
    }
    uint32_t cut(uint32_t begin, uint32_t end) { return halve(begin, end); }
    const BuildReference& at(uint32_t position) const { return references[position]; }
};

} // namespace

Bvh build_equal_counts_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings) {
    check_reference_count(triangles.size());
    EqualCountCuts cuts = {references_of(triangles)};
    return make_bvh(TopDownBuilder(cuts, static_cast<uint32_t>(triangles.size()), *settings.sink).build(), triangles,
                    settings);
}

} // namespace pertev
