#pragma once

// What the builder on the device does otherwise on a GPU than on a CPU: a warp joins the clusters of a node together,
// and wide nodes are made in one launch, each as soon as its parent has placed it. The bytes are the same.

#include "accel/hploc/climb.h"
#include "device/queue.h"
#include "tracer/hploc/emit_wide.h"

namespace pertev {

/// The leaves lie ready (PlaceLeaves).
void launch_climb(Queue& queue, const hploc::Climb& climb);

/// True where the device makes wide nodes this way; else they are made level by level (EmitLevel).
bool launch_emit(Queue& queue, const hploc::EmitWide& emit);

} // namespace pertev
