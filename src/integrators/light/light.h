#pragma once

// Particle tracing, or light tracing: each surface that a particle from a light hits connects to the camera, and so
// does each point of a medium that scatters it; unoccluded connections count for the pixels there. Camera rays add
// directly visible emitters and background, dimmed by media.
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
        run_particles<kIsConnected>(schedule, job);
        schedule.run("begin_camera_subpaths", job.count,
                     BeginCameraSubpaths{job.scene, job.subpaths, job.samples, job.first});
        schedule.find_hits(RayKind::Camera, job, job.count, 0);
        const auto shade = [&]<ShadingVariant kVariant, bool kInMedia>() {
            schedule.run("shade_seen", job.count, ShadeSeen<kVariant, kInMedia>{job.scene, job.subpaths, job.film});
        };
        const SceneView& scene = job.scene.picture.scene;
        if (scene.has_media != 0) return shade.template operator()<ShadingVariant::General, true>();
        with_stacks(scene.variant, [&]<ShadingVariant kVariant>() { shade.template operator()<kVariant, false>(); });
    }
};

} // namespace pertev
