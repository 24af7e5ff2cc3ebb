#pragma once

// Traces the record's ray sets (lab/ray_sets.h) of any scene in isolation, by the tracers that renders use for each
// kind of ray. `pertev bench rays` reports these rates, and `pertev bench render` compares the rays of whole renders
// with them. A CPU traces these rays one after the other, while renders trace packets and several rays at once
// (trace/wide/trace_many.h).

#include <cstdint>
#include <vector>

#include "integrators/integrator.h"
#include "lab/ray_sets.h"
#include "render/prepare_scene.h"
#include "tracer/tracer.h"
#include "tracer/tracer_choice.h"

namespace pertev {

/// Tracer of one ray per thread over binary nodes; the record's node counts belong to this tracer.
inline constexpr Combination kBinaryTracer = {.structure = StructureKind::Binned,
                                              .traversal = TraversalKind::WhileWhile};

/// Builds the combination's tracer, which `sink` may end. Throws Error(OutOfMemory).
Tracer make_tracer(Queue& queue, const Combination& combination, const PreparedScene& prepared, Sink& sink = nobody());

/// The tracer that renders use for rays of this set's kind.
const Combination& tracer_of_pictures(const RaySet& set, const TracerChoice& choice);

/// Makes the record's sets for a scene. `prepared` must come from `scene` and keep its coordinates. Throws
/// Error(Interrupted) if `sink` stops.
std::vector<RaySet> make_isolated_sets(Queue& queue, const Scene& scene, const Camera& camera,
                                       const PreparedScene& prepared, uint32_t count, Sink& sink);

/// Rays per second of each kind in isolation; 0 for a kind without rays.
struct IsolatedRates {
    double camera = 0, bounce = 0, shadow = 0;

    /// The rate of these rays when each kind is traced after the other; 0 where a kind that occurs has no rate.
    double of_mix(const RayCounts& rays) const;
};

/// Measures the record's primary rays as camera rays, its three diffuse sets together as bounces, and its shadow
/// rays. See make_isolated_sets for the arguments. Throws Error(OutOfMemory, DeviceFault).
IsolatedRates measure_isolated_rays(Queue& queue, const Scene& scene, const Camera& camera,
                                    const PreparedScene& prepared, const TracerChoice& choice, uint32_t count,
                                    Sink& sink);

} // namespace pertev
