#pragma once

// Particle tracing, or light tracing: each surface that a particle from a light hits connects to the camera, and
// unoccluded connections count for the pixels there. Camera rays add directly visible emitters and background.
//
// Source: Dutre, Lafortune, Willems, "Monte Carlo Light Tracing with Direct Computation of Pixel Intensities", 1993.
//
// It is unbiased for L(D|G|S)*(D|G)E and LE in Heckbert's notation, and best for caustics. It cannot find paths that
// end in S E, seen in a mirror or through clear glass, because the connection would have to take the only direction
// in which such a surface scatters.

#include "integrators/subpaths/particle_stages.h"
#include "integrators/subpaths/run_subpaths.h"

namespace pertev {

/// The stage that shades the hits of camera rays.
struct ShadeSeen {
    SubpathScene scene;
    SubpathsView subpaths;
    FilmView film;

    HD void operator()(uint32_t i) const {
        const Hit hit = subpaths.hits().load(i);
        const Ray ray = load_ray(subpaths.rays[0] + i);
        const SubpathState state = subpaths.states[i];
        if (hit.instance == kNoHit) return add_seen_background(scene.picture, film, state, ray);
        add_seen(scene.picture, film, state, ray, hit, make_surface(scene.picture.scene, hit, ray.direction));
    }
};

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
        schedule.run("shade_seen", job.count, ShadeSeen{job.scene, job.subpaths, job.film});
    }
};

} // namespace pertev
