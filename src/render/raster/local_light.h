#pragma once

// How a picture without rays is lit: by what a surface emits, an ambient light, and of each point, spot and directional
// light what the diffuse and glossy lobes of its BSDF scatter. No shadow is cast; mirrors and glass are black.

#include "device_scene/surface.h"
#include "render/picture_view.h"

namespace pertev {

struct LocalLight {
    Rgb ambient;        // radiance from all around that diffuse surfaces reflect, W/(sr m2)
    uint32_t max_depth; // 0: what emits alone
};

/// From `surface` towards `wo` (unit), W/(sr m2).
HD inline Rgb local_light(const LightSetView& lights, const Surface& surface, Vec3 wo, const LocalLight& asked) {
    Rgb sum = surface.emission;
    if (surface.is_unlit || asked.max_depth == 0) return sum;
    sum += surface.bsdf.diffuse_albedo() * asked.ambient;
    if (surface.bsdf.has_delta_only()) return sum;
    for (uint32_t k = 0; k < lights.punctual_count; ++k) {
        LightSample sample;
        if (!sample_punctual_light(lights.punctual[k], 1.0f, surface.position, sample)) continue;
        sum += surface.evaluate(wo, sample.wi, kAllLobeClasses).f * sample.radiance;
    }
    return sum;
}

/// What is seen along `direction` (unit) where there is nothing, W/(sr m2).
HD inline Rgb seen_background(const PictureView& picture, Vec3 direction) {
    const LightSetView& lights = picture.scene.lights;
    if (!lights.has_environment() || picture.hide_background) return {};
    return environment_radiance(lights.environment, direction);
}

} // namespace pertev
