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
        const Receiver<kVariant> receiver = here.receiver<kVariant>(scene, pixel);
        const PreparedBounce from = prepare_light(scene, reservoir);
        const Reconnection seen = reconnect(from.position, from.normal, receiver.position());
        if (!seen.is_there) return;
        const float factor = reservoir.weight * diffuse_transmittance<kVariant>(scene, reservoir.hit(), seen.wi);
        const Rgb scattered = factor * light_scattered(scene, receiver, from);
        add_to_sample(film, pixel, scattered, scattered);
    }
};

} // namespace pertev
