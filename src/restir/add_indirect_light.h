#pragma once

// Last stage of indirect light: adds the light from the surface point in a pixel's reservoir to the frame's sample.

#include "render/film_view.h"
#include "restir/bounce_reservoir.h"

namespace pertev {

template <ShadingVariant kVariant>
struct AddIndirectLight {
    SceneView scene;
    PixelSurfaces here;
    const BounceReservoir* reservoirs; // reservoirs whose points are visible from their pixels
    FilmView film;                     // the frame's film view

    HD void operator()(uint32_t pixel) const {
        const BounceReservoir reservoir = reservoirs[pixel];
        if (!(reservoir.weight > 0)) return;
        const Vec3 direction = here.direction(pixel), wo = -direction;
        const Surface surface = here.surface<kVariant>(scene, pixel, direction);
        const Reconnection seen = reconnect(world_triangle(scene, reservoir), surface.position);
        if (!seen.is_there) return;
        const Surface there = make_surface<kVariant>(scene, reservoir.hit(), seen.wi);
        const float factor = reservoir.weight * diffuse_transmittance(there, -seen.wi);
        const Rgb scattered = factor * light_scattered(scene, surface, wo, reservoir);
        add_to_sample(film, pixel, scattered, scattered);
    }
};

} // namespace pertev
