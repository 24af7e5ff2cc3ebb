#pragma once

// The shortest way to a tracer over a prepared scene, or over one tree.

#include <memory>
#include <vector>

#include "render/prepare_scene.h"
#include "render/tracer/tracer.h"

namespace pertev::test {

/// Binary nodes, one ray a thread; and on a CPU eight boxes at a time, which pictures are made with there.
inline constexpr Combination kBinaryTracer = {.structure = StructureKind::Binned, .walk = WalkKind::WhileWhile};
inline constexpr Combination kSimdTracer = {.structure = StructureKind::Binned, .walk = WalkKind::Wide8Simd};

inline Tracer make_tracer(Queue& queue, const PreparedScene& prepared, const Combination& combination = kBinaryTracer) {
    return {queue, combination, prepared.structures->get(combination)};
}

inline Tracer make_tracer(Queue& queue, const Bvh& bvh, const Combination& combination = kBinaryTracer) {
    BinaryTrees trees;
    trees.add(BvhBuilder::Binned, bvh, bvh.triangles.size());
    const auto built =
        std::make_shared<const BuiltStructure>(TopLevelBvh{}, combination.structure, layout_of(combination), trees);
    return {queue, combination, built};
}

} // namespace pertev::test
