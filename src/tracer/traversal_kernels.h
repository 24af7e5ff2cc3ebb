#pragma once

// The table of compiled traversal kernels: every traversal with every set of switches, closest and any hit, on both
// devices. A file in kernels/ adds the rows of each traversal.

#include <cstdint>
#include <optional>
#include <string>

#include "device/queue.h"
#include "device/work_count.h"
#include "device_scene/accept_queued.h"
#include "trace/traversal/traversal_counter.h"
#include "trace/warps/kernel_limits.h"
#include "trace/warps/lane_counter.h"
#include "tracer/built_structure.h"
#include "tracer/combination.h"

namespace pertev {

/// Arguments of one launch, as device pointers. `pool` is a counter that is 0 when the launch runs, for rays that
/// come from a pool.
struct RayBatch {
    TraceQuery query;
    WorkCount count = 0;
    uint32_t* pool = nullptr;
};

struct TraversalKernel {
    TraversalKind traversal{};
    TraversalOptions options;
    Distribution distribution{};
    bool any_hit = false;
    bool on_cuda = false, on_cpu = false; // a traversal whose code differs between devices has a row for each
    void (*trace)(Queue&, const AnyTrees&, const RayBatch&, const HitQueueView&) = nullptr;
    /// Counts nodes and triangles per ray. If null, the row with one ray per thread counts them.
    void (*count)(Queue&, const AnyTrees&, const RayBatch&, RayWork*) = nullptr;
    /// Counts active lanes; null if there are no warps.
    void (*count_lanes)(Queue&, const AnyTrees&, const RayBatch&, LaneCounts*) = nullptr;
    /// Limits of the kernel for scenes with one tree, or of the one for scenes with instances. Null if there is no
    /// kernel.
    KernelLimits (*limits)(bool has_instances) = nullptr;
};

/// Returns why rays cannot be traced by this combination on this kind of device: it is invalid, or no kernel was
/// compiled. Nothing if they can.
std::optional<std::string> why_no_tracer(const Combination& combination, bool on_cuda);

/// Returns the kernel of a combination; null if the combination is invalid or no kernel was compiled for it.
const TraversalKernel* find_kernel(const Combination& combination, bool any_hit, bool on_cuda);

} // namespace pertev
