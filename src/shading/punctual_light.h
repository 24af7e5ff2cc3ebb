#pragma once

// Lights without extent: how each kind sends light to a point, and how a particle leaves it. A new kind is a case in
// each function here.

#include <cstdint>

#include "base/host_device.h"
#include "math/frame.h"
#include "math/rgb.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "scene/light.h"

namespace pertev {

/// scene/light.h's Light without its name.
struct PunctualLight {
    LightKind kind = LightKind::Point;
    Vec3 position, direction; // metres; unit, the way the light travels
    Rgb intensity;            // W/sr; Directional: W/m2
    float cos_inner = 1, cos_outer = 0, range = 0;
    uint32_t number = 0; // in Scene::lights: the table's order is another
};

/// Share of the intensity that a window of `range` metres (0: none) lets reach `distance`.
HD inline float range_falloff(float range, float distance) {
    return range > 0 ? clamp(1.0f - square(square(distance / range)), 0.0f, 1.0f) : 1.0f;
}

/// Share of a punctual light's intensity that reaches `distance` (metres) in direction `wi` (towards the light), as
/// KHR_lights_punctual recommends: the spot's cone is a smooth step in the cosine, squared, and the range a window.
HD inline float punctual_falloff(const PunctualLight& light, Vec3 wi, float distance) {
    switch (light.kind) {
    case LightKind::Point:
        return range_falloff(light.range, distance);
    case LightKind::Spot: {
        const float width = max(0.001f, light.cos_inner - light.cos_outer);
        return range_falloff(light.range, distance) *
               square(clamp((-dot(light.direction, wi) - light.cos_outer) / width, 0.0f, 1.0f));
    }
    case LightKind::Directional:
        break;
    }
    return 1;
}

/// What arrives at a point of a light without extent.
struct PunctualArrival {
    Vec3 wi;            // unit, towards the light
    float distance = 0; // metres; kInfinity of a directional light
    Rgb irradiance;     // W/m2, of a surface that faces it
};

/// False where nothing arrives: outside a cone or the range, or where the receiver is the light.
HD inline bool find_punctual_light(const PunctualLight& light, Vec3 from_point, PunctualArrival& arrival) {
    switch (light.kind) {
    case LightKind::Point:
    case LightKind::Spot: {
        const Vec3 to_light = light.position - from_point;
        const float distance_squared = length_squared(to_light);
        arrival.distance = sqrt(distance_squared);
        arrival.wi = to_light / arrival.distance;
        const float factor = punctual_falloff(light, arrival.wi, arrival.distance) / distance_squared;
        if (!(factor > 0) || !is_finite(factor)) return false;
        arrival.irradiance = factor * light.intensity;
        return true;
    }
    case LightKind::Directional:
        break;
    }
    arrival = {-light.direction, kInfinity, light.intensity};
    return true;
}

/// 1 - cosine of the half angle that a light with a place shines into.
HD inline float depth_of_beam(const PunctualLight& light) {
    return parts_of(light.kind).cone ? 1.0f - light.cos_outer : 2.0f;
}

/// Density of draw_beam, 1/sr.
HD inline float pdf_beam(const PunctualLight& light) {
    return parts_of(light.kind).cone ? pdf_uniform_cone(depth_of_beam(light)) : pdf_uniform_sphere();
}

/// A direction in which a light with a place shines.
HD inline Vec3 draw_beam(const PunctualLight& light, Vec2 u) {
    if (!parts_of(light.kind).cone) return sample_uniform_sphere(u);
    return normalize(make_frame(light.direction).to_world(sample_uniform_cone(u, depth_of_beam(light))));
}

} // namespace pertev
