#pragma once

// A set of rays with what they meet, which every combination is held to. It comes from the proven walk (lab/run_lab.h),
// which itself was held against brute force on some of the rays.

#include <span>
#include <vector>

#include "device/buffer.h"
#include "lab/brute_force_rays.h"
#include "lab/lab_report.h"
#include "lab/ray_sets.h"

namespace pertev {

struct TracedSet {
    SetFigures figures;
    Buffer<Ray> rays;           // on the queue's device
    std::vector<RayHit> wanted; // in the form that HitsOnDevice::download gives for the set's kind
};

/// A scene's triangles, and where instances of those that are not baked stand.
struct LabTriangles {
    SceneTriangles parts;
    TopLevelBvh top_level;
};

/// Some of a set's rays, spread over it, and others from their origins that run along axes or exactly through vertices
/// and along edges of the scene's triangles. A function of its arguments.
std::vector<Ray> oracle_rays(const RaySet& set, const LabTriangles& triangles, uint32_t count, uint32_t nasty_count);

/// Holds the proven walk against brute force on some of the set's rays: how many. Throws Error(DeviceFault) where they
/// differ, with the ray as hex floats.
uint64_t check_proven_walk(Queue& queue, const RaySet& set, const Tracer& proven, const BruteForce& oracle,
                           const LabTriangles& triangles, uint32_t count, uint32_t nasty_count, const PieceDone& done);

/// The set by the proven walk.
TracedSet trace_set(Queue& queue, const RaySet& set, const Tracer& proven, const PieceDone& done);

/// Rays whose result is not the one wanted: in any bit, or, where `exact` is false, in what they meet.
uint64_t count_different(std::span<const RayHit> hits, std::span<const RayHit> wanted, bool exact);

} // namespace pertev
