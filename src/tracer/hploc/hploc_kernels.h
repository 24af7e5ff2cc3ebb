#pragma once

// Launches of the device builder that differ between GPU and CPU. On a GPU a warp merges the clusters of a node, and
// wide nodes are made in a single launch, each as soon as its parent has placed it. The bytes are the same.

#include "accel/hploc/climb.h"
#include "base/sink.h"
#include "device/queue.h"
#include "tracer/hploc/emit_wide.h"

namespace pertev {

/// Merges clusters up to the root; StoreLeaves has written the leaves. On the CPU `sink` may end it.
void launch_climb(Queue& queue, const hploc::Climb& climb, Sink& sink = nobody());

/// Makes all wide nodes in one launch and returns true. Returns false if the device makes them level by level
/// (EmitLevel).
bool launch_emit(Queue& queue, const hploc::EmitWide& emit);

} // namespace pertev
