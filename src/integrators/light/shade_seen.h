#pragma once

// The stage of light tracing that shades what camera rays hit.

#include "integrators/subpaths/particle_stages.h"

namespace pertev {

/// The stage that shades the hits of camera rays; with kInMedia in a scene with media.
template <ShadingVariant kVariant, bool kInMedia = false>
struct ShadeSeen {
    SubpathScene scene;
    SubpathsView subpaths;
    FilmView film;

    HD void operator()(uint32_t i) const {
        const Hit hit = subpaths.hits().load(i);
        const Ray ray = load_ray(subpaths.rays[0] + i);
        const SubpathState state = subpaths.states[i];
        if constexpr (kInMedia) {
            shade_in_media(state, ray, hit);
        } else if (hit.instance == kNoHit) {
            add_seen_background(scene.picture, film, state, ray);
        } else {
            add_seen(scene.picture, film, state, ray, hit,
                     make_surface<kVariant>(scene.picture.scene, hit, ray.direction));
        }
    }

private:
    HD INLINE_ON_DEVICE void shade_in_media(const SubpathState& state, const Ray& ray, const Hit& hit) const {
        const SceneView& view = scene.picture.scene;
        const bool leaves = hit.instance == kNoHit;
        InteriorList list = interior_before(view, scene.picture.camera.interior, ray.direction, hit, kAtRest);
        const MediumTransmittance through_media =
            transmittance_through_media(view, list, ray.origin, ray.direction, leaves ? kInfinity : hit.t);
        if (leaves) return add_seen_background(scene.picture, film, state, ray, through_media.transmittance);
        Surface surface = make_surface<kVariant>(view, hit, ray.direction);
        const Rgb passed = reach_surface(view, list, {}, ray.direction, hit, surface);
        add_seen(scene.picture, film, state, ray, hit, surface, passed * through_media.transmittance);
    }
};

} // namespace pertev
