#pragma once

// Every walk compiled for every set of switches, closest and any hit, on both devices: a table of functions over rays.
// Each walk has one file in lab/kernels/ that makes its rows.

#include <cstdint>
#include <vector>

#include "device/queue.h"
#include "lab/built_structure.h"
#include "lab/trace_rays.h"
#include "trace/kernel_limits.h"
#include "trace/lane_counter.h"

namespace pertev {

/// One launch's arguments: device pointers. `pool` is one counter, used where rays come from a pool.
struct RayBatch {
    const Ray* rays = nullptr;
    uint32_t count = 0;
    uint32_t* pool = nullptr;
};

struct WalkKernel {
    WalkKind walk{};
    WalkOptions options;
    Distribution distribution{};
    bool any_hit = false;
    bool on_cuda = false, on_cpu = false; // a walk whose code differs between devices has rows of its own for each
    void (*trace)(Queue&, const AnyTrees&, const RayBatch&, RayHit*) = nullptr;
    /// Nodes and triangles of each ray; null: the row of one ray a thread tells them.
    void (*count)(Queue&, const AnyTrees&, const RayBatch&, RayWork*) = nullptr;
    /// Null where there are no warps to look at.
    void (*count_lanes)(Queue&, const AnyTrees&, const RayBatch&, LaneCounts*) = nullptr;
    /// Of the kernel for scenes of one tree, or of that for scenes with instances. Null where there is no kernel.
    KernelLimits (*limits)(bool has_instances) = nullptr;
};

/// Null where there is none: the combination makes no sense, or nobody compiled it.
const WalkKernel* find_kernel(const Combination& combination, bool any_hit, bool on_cuda);

} // namespace pertev
