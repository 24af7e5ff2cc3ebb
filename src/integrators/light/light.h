#pragma once

// Particle tracing, or light tracing: particles leave the lights, and each surface that one meets is joined to the
// camera by a ray; what comes through counts for the pixels there. The camera's own rays bring lamps and surroundings
// that it looks straight at.
//
// Source: Dutre, Lafortune, Willems, "Monte Carlo Light Tracing with Direct Computation of Pixel Intensities", 1993.
//
// In Heckbert's words L(D|G|S)*(D|G)E and LE, unbiased, caustics above all. What it cannot find ends in S E: what is
// seen in a mirror or through clear glass, for no ray from a particle to the camera goes the one way that such a
// surface sends light.

#include "integrators/subpaths/particle_stages.h"
#include "integrators/subpaths/run_walks.h"

namespace pertev {

/// What the camera's rays have met.
struct ShadeSeen {
    WalkScene scene;
    WalksView walks;
    FilmView film;

    HD void operator()(uint32_t i) const {
        const Hit hit = walks.hits().load(i);
        const Ray ray = load_ray(walks.rays[0] + i);
        const WalkState state = walks.states[i];
        if (hit.instance == kNoHit) return add_seen_background(scene.picture, film, state, ray);
        add_seen(scene.picture, film, state, ray, hit, make_surface(scene.picture.scene, hit, ray.direction));
    }
};

/// The stages in their order.
struct ParticlesAlone {
    static constexpr bool kIsJoined = false;
    static WalkRoom room(const SubpathSettings&, uint32_t walks) { return {walks, 0, 1}; }

    template <class Way>
    static void render(Way& way, const WalkJob& job) {
        run_particles(way, job);
        way.run("begin_eyes", job.count, BeginEyes{job.scene, job.walks, job.samples, job.first});
        way.find_hits(RayKind::Camera, job, job.count, 0);
        way.run("shade_seen", job.count, ShadeSeen{job.scene, job.walks, job.film});
    }
};

} // namespace pertev
