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

/// A reservoir's point, with what the environment sends from it: the part of its light that is the same for all
/// receivers and takes longest to find.
struct PreparedLight {
    EmitterPoint point; // not there if nothing arrives from it
    Rgb radiance;       // for a point of the environment
};
HD inline PreparedLight prepare_light(const SceneView& scene, const LightReservoir& reservoir) {
    const EmitterPoint& point = reservoir.point;
    switch (point.kind()) {
    case SourceKind::Triangle: // this is the kind, too, if there is no point
    case SourceKind::Punctual:
        return {point, {}};
    case SourceKind::Environment:
        break;
    }
    const Vec3 wi = environment_direction(point);
    const EnvironmentHit hit = find_environment(scene.lights, Vec3(), wi, true);
    return {hit.pdf > 0 ? point : EmitterPoint(), hit.radiance};
}

/// Light that a receiver scatters to its viewer from the reservoir's point without occlusion: the rgb integrand over
/// sample points.
template <ShadingVariant kVariant>
HD inline Rgb light_scattered(const SceneView& scene, const Receiver<kVariant>& receiver, const PreparedLight& from) {
    if (!from.point.is_there()) return {};
    switch (from.point.kind()) {
    case SourceKind::Environment:
        return receiver.evaluate(environment_direction(from.point)).f * from.radiance;
    case SourceKind::Triangle:
    case SourceKind::Punctual:
        break;
    }
    LightSample light;
    float measure = 1;
    const LightContext context = receiver.light_context();
    if (!find_local_light<emitter_variant(kVariant)>(scene.lights, from.point, context, light, measure)) return {};
    return measure * (receiver.evaluate(light.wi).f * light.radiance);
}

/// Makes the shadow ray from a surface's triangle to the point of a reservoir whose weight is above 0; it ends before
/// `target`. Returns false if nothing can arrive. `coin` is the key of blended surfaces for the surface's pixel.
HD inline bool make_visibility_ray(const SceneView& scene, const LightReservoir& reservoir, const WorldTriangle& from,
                                   uint32_t coin, Ray& ray, TriangleId& target) {
    LightSample light;
    if (!find_light_end(scene.lights, reservoir.point, from.position, light)) return false;
    ray = ray_to_light(light, from.position, from.error, from.normal);
    target = triangle_of(light);
    return !is_hole(scene, light, coin);
}

/// Random-number groups of ReSTIR for a pixel's sample, far behind those of paths (integrators/path/path_state.h).
enum RestirGroup : uint32_t {
    kGroupCandidates = 1u << 24, // candidate k of sample s uses point s * candidates + k of the group
    kGroupSelectCandidate,
    kGroupNeighbours, // three groups
    kGroupReuse = kGroupNeighbours + 3,
};

} // namespace pertev
