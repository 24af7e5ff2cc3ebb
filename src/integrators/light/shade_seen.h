#pragma once

// The stage of light tracing that shades what camera rays hit.

#include "integrators/subpaths/particle_stages.h"

namespace pertev {

/// The stage that shades the hits of camera rays.
template <ShadingVariant kVariant>
struct ShadeSeen {
    SubpathScene scene;
    SubpathsView subpaths;
    FilmView film;

    HD void operator()(uint32_t i) const {
        const Hit hit = subpaths.hits().load(i);
        const Ray ray = load_ray(subpaths.rays[0] + i);
        const SubpathState state = subpaths.states[i];
        if (hit.instance == kNoHit) return add_seen_background(scene.picture, film, state, ray);
        add_seen(scene.picture, film, state, ray, hit, make_surface<kVariant>(scene.picture.scene, hit, ray.direction));
    }
};

} // namespace pertev
