#pragma once

// Walks from the camera begin: as path tracing's do, by the same numbers, so that layers of the first surface are
// the same.

#include "integrators/subpaths/particle_stages.h"
#include "render/first_hit.h"

namespace pertev {

/// Walks 0, 1, ... become the camera's of samples `first`, first + 1, ... of `samples`.
struct BeginEyes {
    WalkScene scene;
    WalksView walks;
    BeginOrder samples;
    uint64_t first;

    HD void operator()(uint32_t i) const {
        const CameraRays& camera = scene.picture.camera;
        WalkState state = state_of_sample(samples, first + i, camera);
        const SampleKey key = {state.pixel, state.sample, scene.settings.seed};
        const Ray ray = camera.ray(state.pixel, scene.settings.sampler, key);
        state.throughput = {1, 1, 1};
        state.mis = {min(square(1.0f / camera_density(camera, ray.direction)), kMostOdds), 0};
        state.is_from_far = has_parallel_rays(camera.view.projection) ? 1 : 0;
        walks.states[i] = state;
        walks.queue_ray(i, i, ray, {}, coin_key(key, 0, false), 0);
    }
};

/// What the camera's own rays say of the first surface, and the light that comes straight from it.
HD INLINE_ON_DEVICE void add_seen(const PictureView& picture, const FilmView& film, const WalkState& state,
                                  const Ray& ray, const Hit& hit, const Surface& surface) {
    add_first_hit(film, state.pixel, state.sample, {ray.origin, ray.direction}, hit, surface, picture);
    if (!is_black(surface.emission)) add_radiance(film, state.pixel, surface.emission);
}
/// Of one that met nothing.
HD inline void add_seen_background(const PictureView& picture, const FilmView& film, const WalkState& state,
                                   const Ray& ray) {
    add_no_first_hit(film, state.pixel, state.sample);
    const LightSetView& lights = picture.scene.lights;
    if (!lights.has_environment() || picture.hide_background) return;
    add_radiance(film, state.pixel, environment_radiance(lights.environment, ray.direction));
}

} // namespace pertev
