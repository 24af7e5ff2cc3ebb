#pragma once

// A structure in the memory of the device that traverses it. This is the only place that copies structures to a
// device, and it owns the trees that are built there for meshes whose vertices move.

#include <map>
#include <memory>
#include <span>
#include <utility>
#include <variant>

#include "device/buffer.h"
#include "device_scene/part_arrays.h"
#include "tracer/built_structure.h"
#include "tracer/deforming_tree.h"

namespace pertev {

/// Uploads the TLAS of `scene`: the views of its BLASes, and a tree over its instances. `memory` is reused if it
/// is large enough. Throws Error(OutOfMemory).
template <class View>
void upload_tlas(Queue& queue, Buffer<std::byte>& memory, const std::vector<View>& views, const Tlas& tlas,
                      SceneTrees<View>& scene) {
    PartArrays arrays;
    arrays.add(views, scene.blases);
    arrays.add(tlas.nodes, scene.tlas_nodes);
    arrays.add(tlas.instances, scene.instances);
    arrays.upload(queue, memory, "TLAS of what moves");
    scene.tlas_root = tlas.root;
    scene.tlas_reach = tlas.reach;
    scene.tlas_growth = tlas.growth;
}

/// A structure as a device traverses it: on the CPU a reference to the host's, on a GPU a copy in one allocation.
class StructureOnDevice {
public:
    /// Copies the structure to the device of `queue`, which outlives this, if needed. Throws Error(OutOfMemory).
    StructureOnDevice(Queue& queue, std::shared_ptr<const BuiltStructure> structure)
        : StructureOnDevice(queue, std::move(structure), queue.is_cuda()) {}
    /// Makes a copy even if the device uses host memory, by `is_copied`, for tests.
    StructureOnDevice(Queue& queue, std::shared_ptr<const BuiltStructure> structure, bool is_copied);

    /// Replaces the structure by another one of the same layout. The allocation is reused if it is large enough, and
    /// an array that both have at the same offset is not copied again. trees() keeps its address. Work that is
    /// already queued still sees the old structure. Throws Error(OutOfMemory); nothing may be traced then until the
    /// next update.
    void update(std::shared_ptr<const BuiltStructure> structure);

    /// Refits the trees of these meshes to their present vertices; each is built here the first time. A version that
    /// was already seen is skipped. The layout must satisfy can_deform. Returns the bounds of each mesh. Throws
    /// Error(OutOfMemory, DeviceFault).
    std::vector<Bounds3> deform(std::span<const DeformedMesh> meshes);
    /// Uses, after deform(), the trees of exactly these meshes, and this TLAS over all instances, in place of the
    /// structure's own until the next update with another structure.
    void place(std::span<const DeformedMesh> meshes, const Tlas& tlas);

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
    std::shared_ptr<const BuiltStructure> structure_; // kept alive so that no other array can get its addresses
    AnyTrees trees_;
    Buffer<std::byte> memory_;

    struct Deforming {
        std::variant<DeformingCompressed, DeformingWide> tree;
        uint64_t version = 0;
        Bounds3 bounds;
    };
    std::map<uint32_t, Deforming> deforming_; // by mesh
    Buffer<std::byte> placed_;                // views of the trees, and the TLAS
};

} // namespace pertev
