#pragma once

// Lights without extent: the light of each kind at a point, the emission of particles with its density, and the power.
// Each function has a switch without `default`, so that a new kind does not compile until each has a case.

#include <algorithm>
#include <cstdint>

#include "base/host_device.h"
#include "math/double_pi.h"
#include "math/frame.h"
#include "math/rgb.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "math/vec2.h"
#include "math/vec3.h"
#include "scene/light.h"
#include "shading/goniometric_light.h"

namespace pertev {

/// The Light of scene/light.h without its name.
struct PunctualLight {
    LightKind kind = LightKind::Point;
    Vec3 position, direction; // metres; unit, direction in which the light travels
    Rgb intensity;            // W/sr; Directional: W/m2
    float cos_inner = 1, cos_outer = 0, range = 0;
    uint32_t number = 0; // index in Scene::lights, whose order differs from the table's
    uint32_t table = 0;  // Goniometric: its table; cos_outer is that of a cone around all of its light
};

/// Fraction of the intensity at `distance` under a window of `range` metres (0: none).
HD inline float range_falloff(float range, float distance) {
    return range > 0 ? clamp(1.0f - square(square(distance / range)), 0.0f, 1.0f) : 1.0f;
}

/// Fraction of a punctual light's intensity at `distance` (metres) in direction `wi` (towards the light), as
/// KHR_lights_punctual recommends: the spot's cone is a smooth step in the cosine, squared, and the range is a
/// window. The value of a table is another factor.
HD inline float punctual_falloff(const PunctualLight& light, Vec3 wi, float distance) {
    switch (light.kind) {
    case LightKind::Point:
    case LightKind::Goniometric:
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
/// the point is the light's position. The value of a table is another factor.
HD inline bool find_punctual_light(const PunctualLight& light, Vec3 from_point, PunctualArrival& arrival) {
    switch (light.kind) {
    case LightKind::Point:
    case LightKind::Spot:
    case LightKind::Goniometric: {
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

/// A sphere around everything that rays can hit, in the translated world; distant light enters through its discs.
struct WorldSphere {
    Vec3 centre;
    float radius = 0; // metres; 0 if the world is empty
};

/// Density of the points through which parallel rays enter, 1/m2.
HD inline float pdf_disc(const WorldSphere& world) { return kInvPi / square(world.radius); }
/// Samples a point outside the world, on the disc across `direction`.
HD inline Vec3 sample_disc(const WorldSphere& world, Vec3 direction, Vec2 u) {
    const Vec2 disc = sample_uniform_disk_concentric(u);
    return world.centre + world.radius * make_frame(direction).to_world({disc.x, disc.y, -1});
}

/// 1 - cosine of the half angle in which a light emits; 0 if its light is parallel.
HD inline float depth_of_beam(const PunctualLight& light) {
    switch (light.kind) {
    case LightKind::Point:
        return 2;
    case LightKind::Spot:
    case LightKind::Goniometric:
        return 1.0f - light.cos_outer;
    case LightKind::Directional:
        break;
    }
    return 0;
}

/// A ray of light that leaves a punctual light.
struct PunctualEmission {
    Vec3 from, direction; // metres, translated world; unit
    float reach;          // metres; kInfinity: unlimited
    float pdf;            // 1/sr; Directional: 1/m2, across its direction
};

/// Density of emit_from for a ray along `direction` through the scene. `tables` are those of Goniometric lights.
HD inline float pdf_emission(const PunctualLight& light, const WorldSphere& world, Vec3 direction,
                             const GoniometricTablesView& tables) {
    switch (light.kind) {
    case LightKind::Point:
        return pdf_uniform_sphere();
    case LightKind::Spot:
        return pdf_uniform_cone(depth_of_beam(light));
    case LightKind::Goniometric:
        return pdf_goniometric(tables, light.table, direction);
    case LightKind::Directional:
        break;
    }
    return pdf_disc(world);
}

/// Distance in metres beyond which a light with a position gives no light; kInfinity: unlimited.
HD inline float reach_of(const PunctualLight& light) { return light.range > 0 ? light.range : kInfinity; }

/// Samples a ray that leaves the light.
HD inline PunctualEmission emit_from(const PunctualLight& light, const WorldSphere& world, Vec2 u,
                                     const GoniometricTablesView& tables) {
    switch (light.kind) {
    case LightKind::Point:
        return {light.position, sample_uniform_sphere(u), reach_of(light), pdf_uniform_sphere()};
    case LightKind::Spot: {
        const Vec3 local = sample_uniform_cone(u, depth_of_beam(light));
        return {light.position, normalize(make_frame(light.direction).to_world(local)), reach_of(light),
                pdf_uniform_cone(depth_of_beam(light))};
    }
    case LightKind::Goniometric: {
        PunctualEmission emission = {light.position, {}, reach_of(light), 0};
        emission.direction = sample_goniometric(tables, light.table, u, emission.pdf);
        return emission;
    }
    case LightKind::Directional:
        break;
    }
    return {sample_disc(world, light.direction, u), light.direction, kInfinity, pdf_disc(world)};
}

/// Multiplies `light`, which leaves along `direction`, by the table of a light that has one. Returns false if the table
/// leaves nothing of it.
HD inline bool apply_table(const PunctualLight& of, const GoniometricTablesView& tables, Vec3 direction, Rgb& light) {
    switch (of.kind) {
    case LightKind::Goniometric:
        light = goniometric_value(tables, of.table, direction) * light;
        return !is_black(light);
    case LightKind::Point:
    case LightKind::Spot:
    case LightKind::Directional:
        break;
    }
    return true;
}

/// Power of an emission, W, divided by its density and by `pmf`, the probability of the light.
HD inline Rgb emitted_power(const PunctualLight& light, const PunctualEmission& emission, float pmf,
                            const GoniometricTablesView& tables) {
    const float falloff = punctual_falloff(light, -emission.direction, 0);
    Rgb power = (falloff / (pmf * emission.pdf)) * light.intensity;
    apply_table(light, tables, emission.direction, power);
    return power;
}

/// Returns the power in watts of a light with this intensity; for a directional light, the power that enters a disc
/// of `radius` metres. The edge of a cone is the square of a ramp in the cosine, which contributes a third of its
/// width. A table counts by the mean of its channels.
inline double punctual_power(const Light& light, double intensity, double radius) {
    const double inner = static_cast<double>(light.cos_inner), outer = static_cast<double>(light.cos_outer);
    switch (light.kind) {
    case LightKind::Point:
        return 2 * kPiDouble * intensity * 2;
    case LightKind::Spot:
        return 2 * kPiDouble * intensity * ((1 - inner) + std::max(inner - outer, 0.001) / 3);
    case LightKind::Goniometric: {
        const Rgb of_1 = light.table->integral;
        return intensity * (static_cast<double>(of_1.r) + static_cast<double>(of_1.g) + static_cast<double>(of_1.b)) /
               3;
    }
    case LightKind::Directional:
        break;
    }
    return kPiDouble * radius * radius * intensity;
}

} // namespace pertev
