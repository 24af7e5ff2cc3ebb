#pragma once

// Last stage of direct light: adds the light from the sample point in a pixel's reservoir to the frame's sample.

#include "render/film_view.h"
#include "restir/light_reservoir.h"

namespace pertev {

template <ShadingVariant kVariant>
struct AddDirectLight {
    SceneView scene;
    PixelSurfaces here;
    const LightReservoir* reservoirs; // reservoirs whose points are visible from their pixels
    FilmView film;                    // the frame's film view

    HD void operator()(uint32_t pixel) const {
        const LightReservoir reservoir = reservoirs[pixel];
        if (!(reservoir.weight > 0)) return;
        const Vec3 direction = here.direction(pixel), wo = -direction;
        const Surface surface = here.surface<kVariant>(scene, pixel, direction);
        LightSample light;
        float measure = 1;
        if (!find_light(scene.lights, reservoir.point, surface.light_context(wo), light, measure)) return;
        const Rgb scattered = (reservoir.weight * measure) * (surface.evaluate(wo, light.wi).f * light.radiance);
        const Rgb share = film.frame.splits_light() ? surface.diffuse_share(wo, light.wi) : grey(1);
        add_to_sample(film, pixel, scattered, share * scattered);
    }
};

} // namespace pertev
