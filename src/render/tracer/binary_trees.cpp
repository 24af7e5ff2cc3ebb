#include "render/tracer/binary_trees.h"

#include "base/stopwatch.h"

namespace pertev {

BinaryTrees build_binary_trees(const SceneTriangles& triangles, BvhBuilder builder) {
    const auto parts = std::make_shared<std::vector<Bvh>>();
    const Stopwatch watch;
    for (std::size_t part = 0; part < triangles.parts(); ++part) {
        parts->push_back(build_bvh(builder, triangles.part(part)));
    }
    return {parts, watch.seconds()};
}

} // namespace pertev
