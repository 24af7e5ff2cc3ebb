#pragma once

// A way to trace rays: a structure, its traversal and the distribution of rays, as a Combination names them. All
// exact tracers find bit-identical hits. The laboratory measures tracers; rendering uses one per ray kind
// (tracer/scene_tracer.h).

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "device/buffer.h"
#include "tracer/combination.h"
#include "tracer/structure_on_device.h"
#include "tracer/traversal_kernels.h"

namespace pertev {

class Tracer {
public:
    /// Makes a tracer of a combination that why_no_tracer accepts. `structure` has its layout (layout_of). `queue`
    /// outlives the tracer.
    Tracer(Queue& queue, const Combination& combination, std::shared_ptr<const StructureOnDevice> structure);
    /// Copies the structure to the queue's device for this tracer only. Throws Error(OutOfMemory).
    Tracer(Queue& queue, const Combination& combination, std::shared_ptr<const BuiltStructure> structure)
        : Tracer(queue, combination, std::make_shared<const StructureOnDevice>(queue, std::move(structure))) {}

    /// Finds the closest hits of rays [0, count), at most kMaxPoolCount. The work is queued and may still run on
    /// return. `pool` is a counter in the queue's memory that is 0 when the work begins and is changed if rays come
    /// from a pool. If it is null, the tracer launches a stage that clears a counter of its own. Throws
    /// Error(DeviceFault).
    void find_hits(const TraceQuery& query, WorkCount count, const HitQueueView& hits, uint32_t* pool = nullptr) const {
        trace(*closest_, query, count, hits, pool);
    }
    /// Finds whether the rays hit anything, under the contract of find_hits().
    void find_occlusions(const TraceQuery& query, WorkCount count, const HitQueueView& hits,
                         uint32_t* pool = nullptr) const {
        trace(*any_, query, count, hits, pool);
    }

    // Measurements.

    /// Counts the nodes and triangles that each ray tests. Returns false if the counts depend on the other rays of
    /// its warp.
    bool count_work(bool any_hit, const TraceQuery& query, uint32_t count, RayWork* work) const;
    /// Lane utilization of the traversal; nothing if it is not counted.
    std::optional<LaneCounts> count_lanes(bool any_hit, const TraceQuery& query, uint32_t count) const;
    /// Limits of the closest-hit kernel; nothing on a CPU.
    std::optional<KernelLimits> limits() const;

    const Combination& combination() const { return combination_; }
    const StructureOnDevice& structure() const { return *structure_; }

private:
    void trace(const TraversalKernel& kernel, const TraceQuery& query, WorkCount count, const HitQueueView& hits,
               uint32_t* pool) const;
    uint32_t* empty_pool() const;
    const TraversalKernel& kernel(bool any_hit) const { return any_hit ? *any_ : *closest_; }

    Queue& queue_;
    Combination combination_;
    std::shared_ptr<const StructureOnDevice> structure_;
    const TraversalKernel* closest_;
    const TraversalKernel* any_;
    Buffer<uint32_t> pool_; // [stream]
};

} // namespace pertev
