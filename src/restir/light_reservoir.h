#pragma once

// What a pixel keeps of direct light: one place on a light that stands for all, 32 bytes.

#include "restir/pixel_surfaces.h"
#include "shading/light_place.h"

namespace pertev {

struct alignas(16) LightReservoir {
    LightPlace place;
    float weight = 0;    // of the place: an integral over places is about weight times the integrand there. 0: nothing
    float count = 0;     // candidates' worth that it stands for (M, confidence)
    float seen = 0;      // while reservoirs are combined: shares of those whose pixel sees the place
    uint32_t source = 0; // likewise: which of them it came from
};
static_assert(sizeof(LightReservoir) == 32);

/// Light that a surface scatters to wo from the reservoir's place, were nothing between: rgb of the integrand over
/// places.
HD inline Rgb light_scattered(const SceneView& scene, const Surface& surface, Vec3 wo,
                              const LightReservoir& reservoir) {
    LightSample light;
    float measure = 1;
    if (!find_light(scene.lights, reservoir.place, surface.light_context(wo), light, measure)) return {};
    return measure * (surface.evaluate(wo, light.wi).f * light.radiance);
}

/// The ray from a surface's triangle to the reservoir's place, which ends before `target`. False where it is known that
/// nothing arrives. `coin`: of the surface's pixel.
HD inline bool find_sight(const SceneView& scene, const LightReservoir& reservoir, const PlacedTriangle& from,
                          uint32_t coin, Ray& ray, TriangleId& target) {
    LightSample light;
    float measure = 1;
    if (!find_light(scene.lights, reservoir.place, from.position, light, measure)) return false;
    ray = ray_to_light(light, from.position, from.error, from.normal);
    target = {light.instance, light.primitive};
    const bool may_be_hole = light.instance != kNoLight && scene.any_alpha != 0;
    return !may_be_hole ||
           AcceptHit{scene, {}, {}, coin}.passes_alpha(light.instance, light.primitive, light.b1, light.b2);
}

/// The numbers that ReSTIR draws of a pixel's sample, far behind those of paths (integrators/path/path_state.h).
enum RestirGroup : uint32_t {
    kGroupCandidates = 1u << 24, // of candidate k of sample s: point s * candidates + k of the group
    kGroupPickCandidate,
    kGroupNeighbours, // three of them
    kGroupReuse = kGroupNeighbours + 3,
};

} // namespace pertev
