#pragma once

// A scene's structures in host memory. Each is built at the first request and shared by all tracers and devices.

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

/// Builds the TLAS over instances, with bounds in place of those in `placed` for the meshes that `bounds` lists.
/// Throws Error(OverLimit) that names an instance farther out than kMaxCoordinate.
Tlas tlas_over(std::span<const PlacedBvh> placed, const std::map<uint32_t, Bounds3>& bounds_of_trees);

class SceneStructures {
public:
    /// Takes the trees of `builder`. Trees of other builders are made from their triangles.
    SceneStructures(BvhBuilder builder, BinaryTrees trees, Tlas tlas);

    /// Returns the scene after a change. `trees` are the original ones, updated. Every other structure that has been
    /// built is updated too, and shares its unchanged parts. Only `triangles` of parts that change are read. Throws
    /// as get().
    std::shared_ptr<SceneStructures> updated(BinaryTrees trees, Tlas tlas, const std::vector<PartChange>& changes,
                                             const SceneTriangles& triangles);

    /// Returns the scene with new vertices for some meshes. It works like updated(), on the host, for layouts whose
    /// trees are not kept on the device (can_deform). `placed` lists what the TLAS contains.
    std::shared_ptr<SceneStructures> fitted(Queue& queue, std::span<const DeformedMesh> meshes,
                                            std::span<const PlacedBvh> placed);

    /// Returns the structure that `combination` traverses; builds it at the first request, which `sink` may end.
    /// Thread-safe. Throws Error(OverLimit), std::bad_alloc.
    std::shared_ptr<const BuiltStructure> get(const Combination& combination, Sink& sink = nobody());

    /// Builder of the trees given to the constructor.
    BvhBuilder builder() const { return builder_; }
    uint64_t triangle_count() const { return triangle_count_; } // triangles in the binary trees
    /// Bounds in the translated world: of the baked instances, and of everything that rays can hit.
    const Bounds3& baked_bounds() const { return baked_bounds_; }
    Bounds3 bounds() const {
        Bounds3 all = baked_bounds_;
        all.extend(tlas_.bounds);
        return all;
    }

private:
    const BinaryTrees& binary_trees(BvhBuilder builder, Sink& sink);

    BvhBuilder builder_;
    Tlas tlas_;
    Bounds3 baked_bounds_;
    uint64_t triangle_count_ = 0;
    std::mutex mutex_;
    std::map<BvhBuilder, BinaryTrees> binary_;
    std::map<std::pair<StructureKind, TreeLayout>, std::shared_ptr<const BuiltStructure>> built_;
};

} // namespace pertev
