#pragma once

// A surface as the cache sees it. Records hold the light that comes to a diffuse base, so what lies on it must let
// light in alike whatever is seen: nothing, or one reflection, whose part in f(wo, wi) is a product of one of wo and
// one of wi (lobes/passage.h). The second is in the record, with the surface's material.

#include "device_scene/surface.h"
#include "integrators/irradiance_cache/irradiance_record.h"

namespace pertev {

/// What the diffuse base sends from local wi to wo, of the light that would come evenly: [0, 1] per channel.
HD inline Rgb diffuse_reflectance(const Bsdf& bsdf, Vec3 wo, Vec3 wi) {
    return (kPi / abs(wi.z)) * bsdf.evaluate(wo, wi, only(LobeClass::Diffuse)).f;
}

struct CachedSurface {
    bool is_cached; // light may be looked up there
    float side;     // of the shading normal, seen from wo: 1 or -1

    HD CachedSurface(const Surface& surface, Vec3 wo) {
        const Bsdf& bsdf = surface.bsdf;
        const float height = dot(wo, surface.frame.normal);
        side = height < 0 ? -1.0f : 1.0f;
        is_cached = bsdf.base.kind == LobeKind::Diffuse && !bsdf.is_stacked && height != 0 &&
                    (height > 0) == (dot(wo, surface.geometric_normal) > 0);
    }
};

/// Of a surface that is_cached.
HD inline CachePlace place_of(const Surface& surface, float side, uint32_t scatterings) {
    return {surface.position, side * surface.frame.normal, scatterings,
            surface.bsdf.layer_count == 0 ? kBareDiffuse : surface.material};
}

/// Radiance towards wo of the light of a record, by the diffuse base.
HD inline Rgb sent_on(const Surface& surface, Vec3 wo, float side, Rgb light) {
    return diffuse_reflectance(surface.bsdf, surface.frame.to_local(wo), {0, 0, side}) * light;
}

/// How much of the light along local wi comes to the base, beside that along the normal: 1 where nothing lies on it.
HD inline float let_in(const Bsdf& bsdf, float side, Vec3 wi) {
    if (bsdf.layer_count == 0) return 1;
    const float straight = max_component(diffuse_reflectance(bsdf, {0, 0, side}, {0, 0, side}));
    return straight > 0 ? max_component(diffuse_reflectance(bsdf, {0, 0, side}, wi)) / straight : 0.0f;
}

} // namespace pertev
