#pragma once

// What shade_hit tells of a vertex beside its light: by which lobes, and to which side, light is scattered there, for
// light-path expressions. And what it is told: that the first surface is a light meter, for pictures of irradiance.
// Other renders have NoEvents, of which no code is left.

#include "device_scene/surface.h"

namespace pertev {

struct NoEvents {
    /// The ray has met a surface, before which there were `depth` scatterings.
    HD void meets(Surface&, uint32_t) {}
    /// A shadow ray is asked for, along wi.
    HD void asks_for_light(const Surface&, Vec3, Vec3) {}
    /// The path is scattered.
    HD void goes_on(const Surface&, Vec3, const BsdfSample&) {}
};

/// Share of diffuse lobes, [0, 1] for each colour, in what the surface scatters of light along wi to wo by lobes that
/// are not delta; the rest is by glossy ones. `if_dark` where it scatters nothing.
HD inline Rgb exact_diffuse_share(const Surface& surface, Vec3 wo, Vec3 wi, float if_dark) {
    if (!surface.bsdf.has(LobeClass::Glossy)) return grey(1.0f);
    if (!surface.bsdf.has(LobeClass::Diffuse)) return grey(0.0f);
    const Rgb all = surface.evaluate(wo, wi).f, f = surface.evaluate(wo, wi, only(LobeClass::Diffuse)).f;
    return {all.r > 0 ? min(f.r / all.r, 1.0f) : if_dark, all.g > 0 ? min(f.g / all.g, 1.0f) : if_dark,
            all.b > 0 ? min(f.b / all.b, 1.0f) : if_dark};
}

struct VertexEvents {
    bool is_meter = false; // the first surface is one: it gives its irradiance to the eye, and nothing else

    Rgb light_diffuse; // exact_diffuse_share of the shadow ray
    Rgb diffuse;       // likewise of the direction that the path goes on in, where that is not specular
    bool light_is_transmission = false;
    bool is_specular = false, is_transmission = false;

    HD void meets(Surface& surface, uint32_t depth) {
        if (!is_meter || depth != 0) return;
        surface.bsdf = Bsdf(DiffuseLobe{grey(kPi), 1}); // a white one would have the radiance E / pi
        surface.emission = {};
        surface.is_unlit = false;
    }
    HD INLINE_ON_DEVICE void asks_for_light(const Surface& surface, Vec3 wo, Vec3 wi) {
        light_diffuse = exact_diffuse_share(surface, wo, wi, 0);
        light_is_transmission = !surface.same_side(wo, wi);
    }
    HD INLINE_ON_DEVICE void goes_on(const Surface& surface, Vec3 wo, const BsdfSample& sample) {
        is_specular = sample.is_delta();
        is_transmission = sample.is_transmission;
        const float if_dark = sample.lobe_class == LobeClass::Diffuse ? 1.0f : 0.0f;
        if (!is_specular) diffuse = exact_diffuse_share(surface, wo, sample.wi, if_dark);
    }
};

} // namespace pertev
