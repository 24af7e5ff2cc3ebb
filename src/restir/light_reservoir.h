#pragma once

// A pixel's reservoir of direct light: one sample point on a light that represents all; 32 bytes.

#include "restir/pixel_surfaces.h"
#include "shading/emitter_point.h"

namespace pertev {

struct alignas(16) LightReservoir {
    EmitterPoint point;
    float weight = 0;    // contribution weight W: the integral over points is about W times the integrand; 0 if empty
    float count = 0;     // number of candidates that it represents (M, confidence)
    float seen = 0;      // while reservoirs are combined: sum of the shares of pixels that see the point
    uint32_t source = 0; // while reservoirs are combined: the entry that it came from
};
static_assert(sizeof(LightReservoir) == 32);

/// Light that a surface scatters to wo from the reservoir's point without occlusion: the rgb integrand over sample
/// points.
HD inline Rgb light_scattered(const SceneView& scene, const Surface& surface, Vec3 wo,
                              const LightReservoir& reservoir) {
    LightSample light;
    float measure = 1;
    if (!find_light(scene.lights, reservoir.point, surface.light_context(wo), light, measure)) return {};
    return measure * (surface.evaluate(wo, light.wi).f * light.radiance);
}

/// Makes the shadow ray from a surface's triangle to the reservoir's point, which ends before `target`. Returns false
/// if nothing can arrive. `coin` is the key of blended surfaces for the surface's pixel.
HD inline bool make_visibility_ray(const SceneView& scene, const LightReservoir& reservoir, const WorldTriangle& from,
                                   uint32_t coin, Ray& ray, TriangleId& target) {
    LightSample light;
    float measure = 1;
    if (!find_light(scene.lights, reservoir.point, from.position, light, measure)) return false;
    ray = ray_to_light(light, from.position, from.error, from.normal);
    target = {light.instance, light.primitive};
    const bool may_be_hole = light.instance != kNoLight && scene.any_alpha != 0;
    return !may_be_hole ||
           AcceptHit{scene, {}, {}, coin}.passes_alpha(light.instance, light.primitive, light.b1, light.b2);
}

/// Random-number groups of ReSTIR for a pixel's sample, far behind those of paths (integrators/path/path_state.h).
enum RestirGroup : uint32_t {
    kGroupCandidates = 1u << 24, // candidate k of sample s uses point s * candidates + k of the group
    kGroupSelectCandidate,
    kGroupNeighbours, // three groups
    kGroupReuse = kGroupNeighbours + 3,
};

} // namespace pertev
