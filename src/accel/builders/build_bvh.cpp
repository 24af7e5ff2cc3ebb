#include "accel/builders/build_bvh.h"

#include "base/huge_pages.h"
#include "base/parallel_for.h"
#include "base/parallel_until.h"

namespace pertev {
namespace {

constexpr uint64_t kGrain = 1 << 14;

} // namespace

std::vector<BuildReference> references_of(const std::vector<BvhTriangle>& triangles) {
    auto references = array_on_huge_pages<BuildReference>(triangles.size());
    parallel_for(triangles.size(), kGrain, [&](uint64_t i) {
        const BvhTriangle& t = triangles[i];
        // Adding 0 turns -0 into +0; otherwise a minimum of two zeros would depend on their order.
        const Vec3 zero;
        references[i] = {min(min(t.a, t.b), t.c) + zero, static_cast<uint32_t>(i), max(max(t.a, t.b), t.c) + zero};
    });
    return references;
}

BuiltTree build_triangle_tree(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings) {
    return build_tree(references_of(triangles), settings);
}

Bvh make_bvh(BuiltTree tree, const std::vector<BvhTriangle>& triangles, Sink& sink) {
    Bvh bvh{.nodes = std::move(tree.nodes),
            .triangles = array_on_huge_pages<BvhTriangle>(tree.order.size()),
            .root = tree.root,
            .bounds = tree.bounds,
            .depth = tree.depth,
            .sah_cost = tree.sah_cost};
    parallel_until(tree.order.size(), kGrain, sink, [&](uint64_t i) {
        BvhTriangle t = triangles[tree.order[i]];
        t.flags = tree.is_last[i] ? t.flags | kLastInLeaf : t.flags & ~kLastInLeaf;
        bvh.triangles[i] = t;
    });
    return bvh;
}

Bvh build_bvh(const std::vector<BvhTriangle>& triangles, const BvhBuildSettings& settings) {
    return make_bvh(build_triangle_tree(triangles, settings), triangles, *settings.sink);
}

} // namespace pertev
