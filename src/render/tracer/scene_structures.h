#pragma once

// A scene's structures in the host's memory, each built when it is first asked for: whatever tracers are chosen, and
// however many devices they run on, no structure is built twice.

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "render/tracer/built_structure.h"
#include "render/tracer/tracer_choice.h"

namespace pertev {

class SceneStructures {
public:
    /// `binned`: trees by the builder that pictures are made with, each triangle once; others are made from theirs.
    SceneStructures(BinaryTrees binned, TopLevelBvh top_level);

    /// For the walk of `combination`. May be called from several threads. Throws Error(OverLimit), std::bad_alloc.
    std::shared_ptr<const BuiltStructure> get(const Combination& combination);

    uint64_t triangle_count() const { return triangle_count_; }

    /// Bytes of a device's memory that the structures of a choice take; those not there yet are built.
    std::size_t device_bytes(const TracerChoice& choice);

private:
    const BinaryTrees& binary_trees(BvhBuilder builder);

    TopLevelBvh top_level_;
    uint64_t triangle_count_ = 0; // in all trees
    std::mutex mutex_;
    std::map<BvhBuilder, BinaryTrees> binary_;
    std::map<std::pair<StructureKind, TreeLayout>, std::shared_ptr<const BuiltStructure>> built_;
};

} // namespace pertev
