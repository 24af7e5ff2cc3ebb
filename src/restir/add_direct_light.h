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
        const Receiver<kVariant> receiver = here.receiver<kVariant>(scene, pixel);
        LightSample light;
        float measure = 1;
        constexpr EmitterVariant kEmitters = emitter_variant(kVariant);
        if (!find_light<kEmitters>(scene.lights, reservoir.point, receiver.light_context(), light, measure)) return;
        const Rgb scattered = (reservoir.weight * measure) * (receiver.evaluate(light.wi).f * light.radiance);
        const Rgb share = film.frame.splits_light() ? receiver.diffuse_share(light.wi) : grey(1);
        add_to_sample(film, pixel, scattered, share * scattered);
    }
};

} // namespace pertev
