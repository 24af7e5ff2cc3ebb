#pragma once

// Particle tracing, or light tracing: each surface that a particle from a light hits connects to the camera, and
// unoccluded connections count for the pixels there. Camera rays add directly visible emitters and background.
//
// Source: Dutre, Lafortune, Willems, "Monte Carlo Light Tracing with Direct Computation of Pixel Intensities", 1993.
//
// It is unbiased for L(D|G|S)*(D|G)E and LE in Heckbert's notation, and best for caustics. It cannot find paths that
// end in S E, seen in a mirror or through clear glass, because the connection would have to take the only direction
// in which such a surface scatters.

#include "integrators/light/shade_seen.h"
#include "integrators/subpaths/run_subpaths.h"
#include "shading/with_stacks.h"

namespace pertev {

/// The algorithm of particles alone, which runs the stages in order.
struct ParticlesAlone {
    static constexpr bool kIsConnected = false;
    static SubpathCapacity capacity(const SubpathSettings&, uint32_t subpaths) { return {subpaths, 0, 1}; }

    template <class Schedule>
    static void render(Schedule& schedule, const SubpathJob& job) {
        run_particles(schedule, job);
        schedule.run("begin_camera_subpaths", job.count,
                     BeginCameraSubpaths{job.scene, job.subpaths, job.samples, job.first});
        schedule.find_hits(RayKind::Camera, job, job.count, 0);
        with_stacks(job.scene.picture.scene.variant, [&]<ShadingVariant kVariant>() {
            schedule.run("shade_seen", job.count, ShadeSeen<kVariant>{job.scene, job.subpaths, job.film});
        });
    }
};

} // namespace pertev
