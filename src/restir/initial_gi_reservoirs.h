#pragma once

// First stage of indirect light: makes initial GI reservoirs. It moves the point that each path's first bounce hit,
// and the light found from there, out of the sample into a reservoir.
//
// Source: Ouyang et al. 2021 (bounce_reservoir.h), section 4.1.

#include "render/film_view.h"
#include "restir/bounce_reservoir.h"

namespace pertev {

template <ShadingVariant kVariant>
struct MakeInitialGiReservoirs {
    SceneView scene;
    PixelSurfaces here;
    FilmView film; // the frame's film view
    BounceReservoir* to;

    HD void operator()(uint32_t pixel) const {
        BounceReservoir& reservoir = to[pixel];
        reservoir = {};
        if (!here.is_there(pixel)) return;
        reservoir.count = 1;
        const FirstBounceView& left = film.frame.first_bounce;
        const Float4 hit = left.hit[pixel], diffuse = left.diffuse_contribution[pixel],
                     arrival = left.throughput_and_pdf[pixel];
        const Rgb found = {diffuse.x, diffuse.y, diffuse.z};
        if (bits_of(hit.x) == kNoHit || is_black(found) || film.frame.light[pixel].w == 0) return;
        const Vec3 direction = here.direction(pixel);
        const Surface surface = here.surface<kVariant>(scene, pixel, direction);
        BounceReservoir taken = {};
        taken.instance = bits_of(hit.x);
        taken.primitive = bits_of(hit.y);
        taken.u = hit.z;
        taken.v = hit.w;
        const Reconnection seen = reconnect(world_triangle(scene, taken), surface.position);
        if (!seen.is_there) return; // stays in the sample
        const float transmittance = diffuse_transmittance<kVariant>(scene, taken.hit(), seen.wi);
        if (!(transmittance > 0)) return;
        const Rgb share = diffuse_share_at<kVariant>(surface, -direction, seen.wi);
        if (is_black(share)) return;
        subtract_from_sample(pixel, share * found);
        taken.count = 1;
        taken.side = seen.side;
        taken.radiance = (1.0f / transmittance) *
                         Rgb{quotient(found.r, arrival.x), quotient(found.g, arrival.y), quotient(found.b, arrival.z)};
        taken.weight = 1.0f / (arrival.w * seen.measure);
        if (is_finite(taken.radiance) && is_finite(taken.weight)) reservoir = taken;
    }

private:
    /// Subtracts the light from the sample. The diffuse part contains the same light, rounded by its share.
    HD void subtract_from_sample(uint32_t pixel, Rgb light) const {
        Rgb diffuse = light;
        if (film.frame.splits_light()) {
            const Float4 there = film.frame.diffuse[pixel];
            diffuse = {min(light.r, there.x), min(light.g, there.y), min(light.b, there.z)};
        }
        add_to_sample(film, pixel, -1.0f * light, -1.0f * diffuse);
    }
    HD static float quotient(float light, float throughput) { return throughput > 0 ? light / throughput : 0.0f; }
};

} // namespace pertev
