#pragma once

// A scene's structures in the host's memory, each built when it is first asked for: whatever tracers are chosen, and
// however many devices they run on, no structure is built twice.

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <utility>

#include "device/queue.h"
#include "device_scene/deformed_mesh.h"
#include "tracer/built_structure.h"
#include "tracer/tracer_choice.h"

namespace pertev {

/// The top level over instances, where these trees have other bounds than `placed` says. Throws Error(OverLimit) that
/// names an instance that lies further out than kMaxCoordinate.
TopLevelBvh top_level_over(std::span<const PlacedBvh> placed, const std::map<uint32_t, Bounds3>& bounds_of_trees);

class SceneStructures {
public:
    /// `trees` are by `builder`; others are made from their triangles.
    SceneStructures(BvhBuilder builder, BinaryTrees trees, TopLevelBvh top_level);

    /// The scene after a change. `trees`: those given before, updated. Whatever else has been built is brought up to
    /// date too, parts without a change as they are. Of `triangles` only parts that change are looked at. Throws as
    /// get.
    std::shared_ptr<SceneStructures> updated(BinaryTrees trees, TopLevelBvh top_level,
                                             const std::vector<PartChange>& changes, const SceneTriangles& triangles);

    /// The scene with these vertices of some of its meshes: as updated(), on the host, for layouts whose trees are not
    /// kept on the device (can_deform). `placed`: what the top level is built of.
    std::shared_ptr<SceneStructures> fitted(Queue& queue, std::span<const DeformedMesh> meshes,
                                            std::span<const PlacedBvh> placed);

    /// For the walk of `combination`. May be called from several threads. Throws Error(OverLimit), std::bad_alloc.
    std::shared_ptr<const BuiltStructure> get(const Combination& combination);

    /// Of the trees given at first.
    BvhBuilder builder() const { return builder_; }
    uint64_t triangle_count() const { return triangle_count_; } // in them
    /// In the moved world: of what is baked into it, and of all that rays can meet.
    const Bounds3& baked_bounds() const { return baked_bounds_; }
    Bounds3 bounds() const {
        Bounds3 all = baked_bounds_;
        all.extend(top_level_.bounds);
        return all;
    }

    /// Bytes of a device's memory that the structures of a choice take; those not there yet are built.
    std::size_t device_bytes(const TracerChoice& choice);

private:
    const BinaryTrees& binary_trees(BvhBuilder builder);

    BvhBuilder builder_;
    TopLevelBvh top_level_;
    Bounds3 baked_bounds_;
    uint64_t triangle_count_ = 0;
    std::mutex mutex_;
    std::map<BvhBuilder, BinaryTrees> binary_;
    std::map<std::pair<StructureKind, TreeLayout>, std::shared_ptr<const BuiltStructure>> built_;
};

} // namespace pertev
