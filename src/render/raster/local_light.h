#pragma once

// Local illumination without rays: emission, an ambient light, and light of each point, spot and directional light
// that the diffuse and glossy lobes of the BSDF scatter. There are no shadows; mirrors and glass are black.

#include "device/per_thread.h"
#include "render/picture_view.h"
#include "render/scatter_calls.h"

namespace pertev {

struct LocalLight {
    Rgb ambient;        // radiance from all directions that diffuse surfaces reflect, W/(sr m2)
    uint32_t max_depth; // 0: emission only
};

/// Radiance from `surface` towards `wo` (unit), W/(sr m2).
template <ShadingVariant kVariant>
HD inline Rgb local_light(const LightSetView& lights, const Surface& surface, Vec3 wo, const LocalLight& requested) {
    Rgb sum = surface.emission;
    if (surface.is_unlit || requested.max_depth == 0) return sum;
    sum += surface.bsdf.diffuse_albedo() * requested.ambient;
    if (surface.bsdf.has_delta_only()) return sum;
    for (uint32_t k = per_thread(0, surface.position.x); k < lights.punctual_count; ++k) {
        LightSample sample;
        if (!sample_punctual_light<emitter_variant(kVariant)>(lights, k, 1.0f, surface.position, sample)) continue;
        sum += evaluate_surface<kVariant>(surface, wo, sample.wi).f * sample.radiance;
    }
    return sum;
}

/// Radiance of the background along `direction` (unit), W/(sr m2).
HD inline Rgb seen_background(const PictureView& picture, Vec3 direction) {
    const LightSetView& lights = picture.scene.lights;
    if (!lights.has_environment() || picture.hide_background) return {};
    return environment_radiance(lights.environment, direction);
}

} // namespace pertev
