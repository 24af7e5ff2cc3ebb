#pragma once

// Lights without extent: the light of each kind at a point, and the emission of particles. A new kind is a case in
// parts_of (scene/light.h) and in punctual_falloff.

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

/// The Light of scene/light.h without its name.
struct PunctualLight {
    LightKind kind = LightKind::Point;
    Vec3 position, direction; // metres; unit, direction in which the light travels
    Rgb intensity;            // W/sr; Directional: W/m2
    float cos_inner = 1, cos_outer = 0, range = 0;
    uint32_t number = 0; // index in Scene::lights, whose order differs from the table's
};

/// Fraction of the intensity at `distance` under a window of `range` metres (0: none).
HD inline float range_falloff(float range, float distance) {
    return range > 0 ? clamp(1.0f - square(square(distance / range)), 0.0f, 1.0f) : 1.0f;
}

/// Fraction of a punctual light's intensity at `distance` (metres) in direction `wi` (towards the light), as
/// KHR_lights_punctual recommends: the spot's cone is a smooth step in the cosine, squared, and the range is a
/// window.
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

/// Light of a punctual light at a point.
struct PunctualArrival {
    Vec3 wi;            // unit, towards the light
    float distance = 0; // metres; kInfinity for a directional light
    Rgb irradiance;     // W/m2, on a surface that faces it
};

/// Finds the light that arrives at `from_point`. Returns false if nothing arrives: outside a cone or the range, or if
/// the point is the light's position.
HD inline bool find_punctual_light(const PunctualLight& light, Vec3 from_point, PunctualArrival& arrival) {
    if (!parts_of(light.kind).position) {
        arrival = {-light.direction, kInfinity, light.intensity};
        return true;
    }
    const Vec3 to_light = light.position - from_point;
    const float distance_squared = length_squared(to_light);
    arrival.distance = sqrt(distance_squared);
    arrival.wi = to_light / arrival.distance;
    const float factor = punctual_falloff(light, arrival.wi, arrival.distance) / distance_squared;
    if (!(factor > 0) || !is_finite(factor)) return false;
    arrival.irradiance = factor * light.intensity;
    return true;
}

/// 1 - cosine of the half angle of a light with a position.
HD inline float depth_of_beam(const PunctualLight& light) {
    return parts_of(light.kind).cone ? 1.0f - light.cos_outer : 2.0f;
}

/// Density of draw_beam, 1/sr.
HD inline float pdf_beam(const PunctualLight& light) {
    return parts_of(light.kind).cone ? pdf_uniform_cone(depth_of_beam(light)) : pdf_uniform_sphere();
}

/// Samples a direction in which a light with a position emits.
HD inline Vec3 draw_beam(const PunctualLight& light, Vec2 u) {
    if (!parts_of(light.kind).cone) return sample_uniform_sphere(u);
    return normalize(make_frame(light.direction).to_world(sample_uniform_cone(u, depth_of_beam(light))));
}

} // namespace pertev
