#pragma once

// The CPU body of the path integrator: a thread renders all paths of some pixels, many of them side by side, so that
// rays of one kind are traced together. Its functions are those of the wavefront's stages.

#include "integrators/integrator.h"
#include "integrators/path/path_job.h"
#include "render/begin_order.h"
#include "render/raster/find_in_tile.h"
#include "trace/scene_trees.h"

namespace pertev {

/// The trees in which rays are traced. `raster`, if present, finds primary visibility.
struct LoopTrees {
    const HostTrees& trees;
    const TileRasterView* raster;
};

/// Pixels at [begin, end) of an order.
struct PixelRange {
    uint32_t begin, end;
};

/// Adds the samples of these pixels to the job's film and its layers, if any. Rays other than camera rays are added to
/// `counts`.
void render_pixels(const PathJob& job, const LoopTrees& trees, const BeginOrder& order, PixelRange range,
                   RayCounts& counts);
#if defined(PERTEV_HAS_16_LANES)
/// Renders as render_pixels, by code for processors with AVX-512 (base/processor.h).
void render_pixels_by_avx_512(const PathJob& job, const LoopTrees& trees, const BeginOrder& order, PixelRange range,
                              RayCounts& counts);
#endif

} // namespace pertev
