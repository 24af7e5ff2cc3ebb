#include "tracer/binary_trees.h"

#include <numeric>

#include "accel/builders/refit_bvh.h"
#include "base/stopwatch.h"

namespace pertev {

uint64_t BinaryTrees::triangle_count() const {
    return std::accumulate(triangles.begin(), triangles.end(), uint64_t(0));
}

std::vector<Bounds3> BinaryTrees::blas_bounds() const {
    std::vector<Bounds3> bounds;
    for (std::size_t part = 1; part < parts.size(); ++part) bounds.push_back(parts[part]->bounds);
    return bounds;
}

BinaryTrees build_binary_trees(const SceneTriangles& triangles, BvhBuilder builder, Sink& sink) {
    BinaryTrees trees;
    const Stopwatch watch;
    for (std::size_t part = 0; part < triangles.parts(); ++part) {
        const std::vector<BvhTriangle>& list = triangles.part(part);
        trees.add(builder, build_bvh(builder, list, {.sink = &sink}), list.size());
    }
    trees.build_s = watch.seconds();
    return trees;
}

BinaryTrees update_binary_trees(const BinaryTrees& before, BvhBuilder builder, const std::vector<PartChange>& changes,
                                const SceneTriangles& triangles) {
    BinaryTrees trees = before;
    const Stopwatch watch;
    for (std::size_t part = 0; part < changes.size(); ++part) {
        if (changes[part] == PartChange::None) continue;
        BvhBuilder& own = trees.builders[part];
        if (changes[part] == PartChange::Replaced) {
            own = builder;
        } else if (why_no_refit(own)) {
            own = kRefittedBuilder;
        } else {
            auto refitted = std::make_shared<const Bvh>(refit_bvh(*before.parts[part], triangles.part(part)));
            trees.parts[part] = std::move(refitted);
            if (trees.parts[part]->sah_cost <= kMaxRefitCost * before.built_cost[part]) continue;
        }
        trees.parts[part] = std::make_shared<const Bvh>(build_bvh(own, triangles.part(part)));
        trees.built_cost[part] = trees.parts[part]->sah_cost;
        trees.triangles[part] = triangles.part(part).size();
    }
    trees.build_s = watch.seconds();
    return trees;
}

} // namespace pertev
