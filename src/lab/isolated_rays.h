#pragma once

// The record's sets of rays (lab/ray_sets.h) in any scene, traced by themselves by what pictures trace rays of their
// kind by: what `pertev bench rays` measures, and what `pertev bench render` holds the rays of whole pictures to. On a
// CPU they go one after the other, where pictures go by packets and several in flight (trace/wide/trace_many.h).

#include <cstdint>
#include <functional>
#include <vector>

#include "integrators/integrator.h"
#include "lab/ray_sets.h"
#include "render/prepare_scene.h"
#include "tracer/tracer.h"
#include "tracer/tracer_choice.h"

namespace pertev {

/// Binary nodes, one ray a thread: what the record's counts of nodes are of.
inline constexpr Combination kBinaryTracer = {.structure = StructureKind::Binned, .walk = WalkKind::WhileWhile};

/// Throws Error(OutOfMemory).
Tracer make_tracer(Queue& queue, const Combination& combination, const PreparedScene& prepared);

/// What pictures trace rays of the set's kind by.
const Combination& tracer_of_pictures(const RaySet& set, const TracerChoice& choice);

/// `prepared` is of `scene` and keeps its coordinates. `between()` is asked now and then; it may throw to end this.
std::vector<RaySet> make_isolated_sets(Queue& queue, const Scene& scene, const Camera& camera,
                                       const PreparedScene& prepared, uint32_t count,
                                       const std::function<void()>& between);

/// Rays a second of each kind by themselves; 0: none was there.
struct IsolatedRates {
    double camera = 0, bounce = 0, shadow = 0;

    /// Of so many rays of each kind, one kind after the other; 0 where one has no rate.
    double of_mix(const RayCounts& rays) const;
};

/// Primary rays of the record as the camera's, its three sets of diffuse ones together as bounces, and its shadow rays.
/// Arguments as make_isolated_sets has them. Throws Error(OutOfMemory, DeviceFault).
IsolatedRates measure_isolated_rays(Queue& queue, const Scene& scene, const Camera& camera,
                                    const PreparedScene& prepared, const TracerChoice& choice, uint32_t count,
                                    const std::function<void()>& between);

} // namespace pertev
