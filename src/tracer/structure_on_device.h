#pragma once

// A structure where a walk of it runs. This is the one place that knows how a structure comes to a device, and the
// owner of the trees that are made there of meshes whose vertices move.

#include <map>
#include <memory>
#include <span>
#include <utility>
#include <variant>

#include "device/buffer.h"
#include "tracer/built_structure.h"
#include "tracer/deforming_tree.h"

namespace pertev {

/// On the host where that is the device, else a copy in one piece.
class StructureOnDevice {
public:
    /// `queue` outlives it. Throws Error(OutOfMemory).
    StructureOnDevice(Queue& queue, std::shared_ptr<const BuiltStructure> structure)
        : StructureOnDevice(queue, std::move(structure), queue.is_cuda()) {}
    /// `is_copied`: also where the host's memory is the device's, as tests want it.
    StructureOnDevice(Queue& queue, std::shared_ptr<const BuiltStructure> structure, bool is_copied);

    /// Puts `structure`, which is in the same layout, in the place of the one before. The memory stays where it is
    /// large enough; an array that the one before has too, at the same place, is not copied again. trees() stays where
    /// it is. Work that was queued before still sees the structure before. Throws Error(OutOfMemory), after which
    /// nothing may be traced until the next update.
    void update(std::shared_ptr<const BuiltStructure> structure);

    /// Fits trees to these meshes as they are now, each made here at first; nothing is done for a version that has been
    /// seen. The layout is one that can_deform. Returns the bounds of each. Throws Error(OutOfMemory, DeviceFault).
    std::vector<Bounds3> deform(std::span<const DeformedMesh> meshes);
    /// After deform(): puts the trees of these meshes, and of no others, and this top level over all instances in the
    /// place of the structure's own, until the next update with another structure.
    void place(std::span<const DeformedMesh> meshes, const TopLevelBvh& top_level);

    const AnyTrees& trees() const { return trees_; }
    const BuiltStructure& built() const { return *structure_; }

private:
    void copy(const BuiltStructure* before);
    template <class T>
    const T* moved(const T* on_host) const;
    template <class View>
    void move(View& view) const;
    template <class View>
    SceneTrees<View> moved_scene(SceneTrees<View> scene, const BuiltStructure* before);

    Queue& queue_;
    bool is_copied_;
    std::shared_ptr<const BuiltStructure> structure_; // kept, so that its arrays' addresses go to no other array
    AnyTrees trees_;
    Buffer<std::byte> memory_;

    struct Deforming {
        std::variant<DeformingCompressed, DeformingWide> tree;
        uint64_t version = 0;
        Bounds3 bounds;
    };
    std::map<uint32_t, Deforming> deforming_; // by mesh
    Buffer<std::byte> placed_;                // views of trees, and the top level
};

} // namespace pertev
