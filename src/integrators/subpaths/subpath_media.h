#pragma once

// Subpaths in scenes with media: their free flights, and their vertices where one ends. In MIS weights a free flight is
// part of a technique's density: the probability that it passes a segment multiplies both directions' densities. The
// extinction at a point of a medium is part of all techniques' densities, because each samples the point by a flight,
// so it cancels. The flight samples by the throughput, which the other subpath does not know, so weights have the
// probability's mean over the colours instead. They add up to 1 for any such number.
//
// Sources: Lafortune, Willems, "Rendering Participating Media with Bidirectional Path Tracing", EGWR 1996; Pauly,
// Kollig, Keller, "Metropolis Light Transport for Participating Media", EGWR 2000, section 3.

#include "device_scene/free_flight.h"
#include "device_scene/interior_of_light.h"
#include "integrators/subpaths/emit_particle.h"
#include "integrators/subpaths/subpath_vertex.h"
#include "shading/phase_function.h"

namespace pertev {

/// A vertex of a subpath in a medium, with the functions of SurfaceEnd.
struct MediumEnd {
    MediumPoint point;
    Vec3 along;      // direction in which the subpath arrived, unit
    float share = 1; // share of the throughput that the flight to it left

    HD Vec3 position() const { return point.position; }
    HD TriangleId triangle() const { return {}; }
    HD bool scatters_by_delta_alone() const { return false; }
    HD float density_factor(Vec3) const { return 1; }
    HD BsdfValue scatter_camera(Vec3 wo, Vec3 wi) const { return scatter(wo, wi).camera; }
    HD BothWays scatter(Vec3 wo, Vec3 wi) const {
        const float density = henyey_greenstein(point.g, -dot(wo, wi));
        return {{grey(density), density}, {grey(density), density}};
    }
    HD Vec3 origin_towards(Vec3) const { return point.position; }
    HD LightContext light_context(Vec3) const { return {point.position}; }
    HD Ray ray_to(const LightSample& light) const { return ray_to_light(light, point.position, {0, 0, 0}, light.wi); }
    HD bool same_side(Vec3, Vec3) const { return true; }
    HD ScatterDraw draw(const SubpathSettings& settings, SampleKey key, uint32_t scatter_group, uint32_t) const {
        return {0.5f, sample_2d(settings.sampler, key, scatter_group)};
    }
    HD BsdfSample sample_camera(Vec3 wo, const ScatterDraw& draw) const {
        const Vec3 wi = sample_henyey_greenstein(point.g, -wo, draw.u);
        return make_bsdf_sample(wi, scatter(wo, wi).camera, LobeClass::Diffuse);
    }
    HD BsdfSample sample_particle(Vec3 wi, const ScatterDraw& draw) const { return sample_camera(wi, draw); }
    /// Returns whether the subpath survives Russian roulette, for which the flight's share of the throughput is the
    /// vertex's.
    HD bool survives(const SubpathSettings& settings, SampleKey key, uint32_t group, uint32_t vertex,
                     BsdfSample& sample) const {
        sample.weight = share * sample.weight;
        if (!(share > 0) || !pertev::survives(settings, key, group, vertex, sample)) return false;
        sample.weight = (1.0f / share) * sample.weight;
        return true;
    }
    HD float squared_index_beyond(Vec3, float here) const { return here; }
    HD float squared_index_along(Vec3, Vec3, float here) const { return here; }
};

/// Returns the point of a medium that `list` names.
HD inline MediumPoint medium_point(const SceneView& scene, InteriorList list, Vec3 position) {
    const uint32_t rank = list.top();
    const MaterialParameters& filling =
        rank == 0 ? *scene.surroundings : scene.materials[material_of_solid(scene, list)];
    return {position, filling.medium.sigma_t(), filling.medium.g,
            rank == 0 ? scene.instance_count : scene.nesting.solids[rank]};
}

/// Returns the solids that hold a ray from a vertex along a direction; `list` has those on the side of `from`.
template <class End>
HD inline InteriorList interior_towards(const SceneView& scene, InteriorList list, const End& end, Vec3 from,
                                        Vec3 along) {
    if (!scene.nesting.is_there() || end.same_side(from, along)) return list;
    return solids_behind(scene, list, end.triangle().instance);
}

/// Follows a subpath through the interface of a surface that it has reached, after the media before it. Returns the
/// transmittance of a solid on the way that media have not counted.
HD_CALL inline Rgb reach_surface(const SceneView& scene, InteriorList& list, TriangleId start, Vec3 direction,
                                 const Hit& hit, Surface& surface) {
    if (scene.nesting.is_there()) {
        list = solids_before(scene, list, hit.instance, dot(direction, surface.geometric_normal) < 0);
        nest_surface(scene, list, surface);
        if (list.top() != 0) return {1, 1, 1};
    }
    return transmittance_of_solid(scene, start, {hit.instance, hit.primitive}, direction, hit.t, kAtRest);
}

/// Returns the transmittance of a connection along `direction`, whose ends are on the triangles `start` and `end` if
/// they are on any. `list` has the solids that hold its start.
HD_CALL inline MediumTransmittance transmittance_of_connection(const SceneView& scene, InteriorList list, Vec3 from,
                                                               Vec3 direction, float distance, TriangleId start,
                                                               TriangleId end) {
    MediumTransmittance through_media = transmittance_through_media(scene, list, from, direction, distance);
    if (list.top() == 0) {
        through_media.transmittance =
            through_media.transmittance * transmittance_of_solid(scene, start, end, direction, distance, kAtRest);
    }
    return through_media;
}

/// Stores the solids that hold the beginning of a particle's ray. Light from infinity has passed the scene's own
/// medium.
HD inline void begin_in_media(const SceneView& scene, const SubpathsView& subpaths, uint32_t subpath,
                              Particle& particle) {
    const Ray& ray = particle.ray;
    subpaths.store_interior(subpath,
                            interior_of_light(scene, particle.light, particle.start, ray.origin, ray.direction));
    if (!particle.is_from_far) return;
    particle.power = particle.power * transmittance_of(optical_depth(scene.surroundings->medium.sigma_t(), kInfinity));
}

/// A free flight of a subpath.
struct SubpathFlight {
    bool is_scattered;
    float distance;    // metres; kInfinity if it leaves the scene
    float probability; // FlownMedia::probability()
    float share;       // share of the throughput that it left
    MediumPoint point; // if it is scattered
};

/// Lets a subpath fly along its ray up to `hit`, and weights its throughput. A ray that came from infinity has passed
/// the scene's own medium, too.
HD INLINE_ON_DEVICE SubpathFlight fly(const SubpathScene& scene, SampleKey key, uint32_t group, const Ray& ray,
                                      const Hit& hit, bool is_light_from_far, InteriorList& list, Rgb& throughput) {
    const SceneView& view = scene.picture.scene;
    const float before = throughput.r + throughput.g + throughput.b;
    const SampleBits u = sample_bits(scene.settings.sampler, key, kGroupMedium + group, Pair::First);
    SubpathFlight flight = {};
    FlownMedia flown;
    flight.is_scattered = sample_free_flight(view, list, ray.origin, ray.direction, hit, ray.t_max, kAtRest, u,
                                             throughput, flight.point, flown);
    if (is_light_from_far && view.surroundings->medium.scatters()) {
        flown.sampled += optical_depth(view.surroundings->medium.sigma_t(), kInfinity);
    }
    flight.probability = max(flown.probability(), 0x1p-40f);
    flight.share = min((throughput.r + throughput.g + throughput.b) / before, 1.0f);
    flight.distance = flight.is_scattered      ? length(flight.point.position - ray.origin)
                      : hit.instance == kNoHit ? kInfinity
                                               : hit.t;
    return flight;
}

} // namespace pertev
