#pragma once

// The CPU's body of the path integrator: one thread takes paths of some pixels from the camera to their end, many of
// them side by side, so that rays of one kind are traced together. Its functions are those of the wavefront's stages.

#include "integrators/integrator.h"
#include "integrators/path/path_job.h"
#include "render/begin_order.h"
#include "render/raster/find_in_tile.h"
#include "trace/scene_trees.h"

namespace pertev {

/// What rays are traced in; what camera rays meet is found in `raster` where there is one.
struct LoopTrees {
    const HostTrees& trees;
    const TileRasterView* raster;
};

/// Adds the samples to the job's film, and to those layers that there are. What was traced beside camera rays is added
/// to `counts`.
void render_pixels(const PathJob& job, const LoopTrees& trees, const BeginOrder& work, RayCounts& counts);

} // namespace pertev
