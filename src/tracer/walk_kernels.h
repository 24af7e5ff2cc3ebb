#pragma once

// Every walk compiled for every set of switches, closest and any hit, on both devices: a table of functions over queues
// of rays. Each walk has one file in kernels/ that makes its rows.

#include <cstdint>
#include <optional>
#include <string>

#include "device/queue.h"
#include "device/work_count.h"
#include "device_scene/accept_queued.h"
#include "trace/traversal/walk_counter.h"
#include "trace/warps/kernel_limits.h"
#include "trace/warps/lane_counter.h"
#include "tracer/built_structure.h"
#include "tracer/combination.h"

namespace pertev {

/// One launch's arguments: device pointers. `pool` is one number, 0 when the launch runs, where rays come from
/// a pool.
struct RayBatch {
    TraceQuery query;
    WorkCount count = 0;
    uint32_t* pool = nullptr;
};

struct WalkKernel {
    WalkKind walk{};
    WalkOptions options;
    Distribution distribution{};
    bool any_hit = false;
    bool on_cuda = false, on_cpu = false; // a walk whose code differs between devices has rows of its own for each
    void (*trace)(Queue&, const AnyTrees&, const RayBatch&, const HitQueueView&) = nullptr;
    /// Nodes and triangles of each ray; null: the row of one ray a thread tells them.
    void (*count)(Queue&, const AnyTrees&, const RayBatch&, RayWork*) = nullptr;
    /// Null where there are no warps to look at.
    void (*count_lanes)(Queue&, const AnyTrees&, const RayBatch&, LaneCounts*) = nullptr;
    /// Of the kernel for scenes of one tree, or of that for scenes with instances. Null where there is no kernel.
    KernelLimits (*limits)(bool has_instances) = nullptr;
};

/// Why rays cannot be traced so on this kind of device: the combination makes no sense, or nobody compiled it. Nothing
/// when they can.
std::optional<std::string> why_no_tracer(const Combination& combination, bool on_cuda);

/// Null where there is none: the combination makes no sense, or nobody compiled it.
const WalkKernel* find_kernel(const Combination& combination, bool any_hit, bool on_cuda);

} // namespace pertev
