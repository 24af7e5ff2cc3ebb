#pragma once

// Beginning paths and tracing their camera rays in one launch, in which a ray goes to its traversal in registers. Two
// launches, of which the second loads what the first has stored, are 1 to 5 % of a picture slower
// (docs/performance.md).

#include "integrators/path/path_stages.h"
#include "tracer/scene_tracer.h"

namespace pertev {

/// Begins `fresh` paths and finds the hits of their camera rays, as `generate` and SceneTracer::find_hits() of
/// RayKind::Camera do one after the other. Returns false without doing anything unless camera rays use the default
/// traversal of a GPU on a scene that is at rest while the shutter is open, and if rays of each kind are timed.
template <bool kInBatch>
bool begin_and_trace(Queue& queue, const SceneTracer& tracer, WorkCount fresh, const GeneratePaths<kInBatch>& generate,
                     const HitQueueView& hits);

} // namespace pertev
