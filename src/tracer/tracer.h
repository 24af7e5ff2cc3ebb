#pragma once

// One way to find what rays meet: a structure, the walk of it and how rays are handed out, as one Combination names
// them. All that are exact give the same hits to the bit. The laboratory measures these; pictures take one for each
// kind of ray (tracer/scene_tracer.h).

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include "device/buffer.h"
#include "tracer/combination.h"
#include "tracer/structure_on_device.h"
#include "tracer/walk_kernels.h"

namespace pertev {

class Tracer {
public:
    /// `structure` is in the layout of the combination (layout_of), which why_no_tracer has nothing against. `queue`
    /// outlives the tracer.
    Tracer(Queue& queue, const Combination& combination, std::shared_ptr<const StructureOnDevice> structure);
    /// Places the structure on the queue's device first, for this tracer alone. Throws Error(OutOfMemory).
    Tracer(Queue& queue, const Combination& combination, std::shared_ptr<const BuiltStructure> structure)
        : Tracer(queue, combination, std::make_shared<const StructureOnDevice>(queue, std::move(structure))) {}

    /// What rays [0, count) meet first. Queued: the work may still be under way. At most kMaxPoolCount of them.
    /// `pool`: a number in the queue's memory that is 0 by then, which spares a launch that sets one of the tracer's
    /// own to 0, as it does for null; it is changed where rays come from a pool. Throws Error(DeviceFault).
    void find_hits(const TraceQuery& query, WorkCount count, const HitQueueView& hits, uint32_t* pool = nullptr) const {
        trace(*closest_, query, count, hits, pool);
    }
    /// Whether they meet anything.
    void find_occlusions(const TraceQuery& query, WorkCount count, const HitQueueView& hits,
                         uint32_t* pool = nullptr) const {
        trace(*any_, query, count, hits, pool);
    }

    // For measurements.

    /// Nodes and triangles that each ray tests. False where nothing can tell: the ray's company has a say in it.
    bool count_work(bool any_hit, const TraceQuery& query, uint32_t count, RayWork* work) const;
    /// What warps make of it; nothing where there are none to look at.
    std::optional<LaneCounts> count_lanes(bool any_hit, const TraceQuery& query, uint32_t count) const;
    /// Of the kernel of closest hits; nothing on a CPU.
    std::optional<KernelLimits> limits() const;

    const Combination& combination() const { return combination_; }
    const StructureOnDevice& structure() const { return *structure_; }

private:
    void trace(const WalkKernel& kernel, const TraceQuery& query, WorkCount count, const HitQueueView& hits,
               uint32_t* pool) const;
    uint32_t* empty_pool() const;
    const WalkKernel& kernel(bool any_hit) const { return any_hit ? *any_ : *closest_; }

    Queue& queue_;
    Combination combination_;
    std::shared_ptr<const StructureOnDevice> structure_;
    const WalkKernel* closest_;
    const WalkKernel* any_;
    Buffer<uint32_t> pool_; // one for each stream
};

} // namespace pertev
