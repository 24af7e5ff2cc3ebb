#pragma once

// A set of rays with reference hits that every combination is compared with. The reference traversal (lab/run_lab.h)
// traces them; it is itself compared with brute force on some of the rays.

#include <span>
#include <vector>

#include "device/buffer.h"
#include "lab/brute_force_rays.h"
#include "lab/lab_report.h"
#include "lab/ray_sets.h"

namespace pertev {

struct TracedSet {
    SetFigures figures;
    Buffer<Ray> rays;           // in the queue's device memory
    std::vector<RayHit> wanted; // expected hits, in the form that HitsOnDevice::download returns for this kind of set
};

/// A scene's triangles, and transforms of the instances that are not baked.
struct LabTriangles {
    SceneTriangles parts;
    Tlas tlas;
};

/// Returns some rays spread over the set, and other rays from their origins that run along axes or exactly through
/// vertices and edges of the scene's triangles. The result depends only on the arguments.
std::vector<Ray> oracle_rays(const RaySet& set, const LabTriangles& triangles, uint32_t count, uint32_t stress_count);

/// Compares the reference traversal with brute force on some of the set's rays and returns their number. Throws
/// Error(DeviceFault) with the ray as hex floats if they differ.
uint64_t check_reference_traversal(Queue& queue, const RaySet& set, const Tracer& reference, const BruteForce& oracle,
                                   const LabTriangles& triangles, uint32_t count, uint32_t stress_count,
                                   const PieceDone& done);

/// Traces the set by the reference traversal.
TracedSet trace_set(Queue& queue, const RaySet& set, const Tracer& reference, const PieceDone& done);

/// Counts rays whose hit differs from the wanted one: in any bit, or, if `exact` is false, in the surface that is
/// hit.
uint64_t count_different(std::span<const RayHit> hits, std::span<const RayHit> wanted, bool exact);

} // namespace pertev
