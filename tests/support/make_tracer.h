#pragma once

// Makes a tracer over a prepared scene, or over one tree.

#include <memory>
#include <vector>

#include "lab/isolated_rays.h"
#include "render/prepare_scene.h"
#include "tracer/tracer.h"

namespace pertev::test {

using pertev::kBinaryTracer;
/// Returns the combination that pictures use; on a CPU it tests eight boxes at a time.
inline constexpr Combination kSimdTracer = {.structure = StructureKind::Binned, .traversal = TraversalKind::Wide8Simd};

inline Tracer make_tracer(Queue& queue, const PreparedScene& prepared, const Combination& combination = kBinaryTracer) {
    return pertev::make_tracer(queue, combination, prepared);
}

inline Tracer make_tracer(Queue& queue, const Bvh& bvh, const Combination& combination = kBinaryTracer) {
    BinaryTrees trees;
    trees.add(BvhBuilder::Binned, bvh, bvh.triangles.size());
    const auto built =
        std::make_shared<const BuiltStructure>(Tlas{}, combination.structure, layout_of(combination), trees);
    return {queue, combination, built};
}

} // namespace pertev::test
