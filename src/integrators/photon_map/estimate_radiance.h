#pragma once

// Light that a diffuse surface sends on, estimated from the photons near a place of it: of those within the radius r
//     L = sum over photons of f(wo, wi) power / (pi r^2),
// f being the diffuse lobes' BSDF. Photons on surfaces that are turned away by more than 45 degrees belong to another
// wall and do not count.
//
// Sources: Jensen, "Global Illumination using Photon Maps", 1996, section 5; of the k nearest the farthest sets the
// radius and does not count itself: so the mean is right where photons lie evenly (Loftsgaarden, Quesenberry 1965).
//
// Sums within a radius are by integers, so they do not depend on the order in which a structure meets the photons; the
// k nearest are added in their order (distance, number). So all structures give the same bytes.

#include "integrators/photon_map/gather_memory.h"
#include "integrators/photon_map/photon_map_view.h"
#include "integrators/subpaths/walk_vertex.h"
#include "render/film_view.h"

namespace pertev {

/// Both maps of a pass.
struct PhotonMapsView {
    PhotonMapView global, caustic;
    bool global_has_all = false; // the caustic map's photons too
};

template <MaterialsKnown kKnown, PhotonSearch kSearch>
struct EstimateRadiance {
    WalkScene scene;
    WalksView walks;
    GatherView gather;
    PhotonMapsView maps;
    FilmView film;

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const Lookup lookup = gather.load(i);
        const Surface surface = make_surface<kKnown>(scene.picture.scene, lookup.hit, lookup.direction);
        // Scatterings of a photon at most: the surface itself is one more.
        const uint32_t most = scene.settings.max_depth - lookup.scatterings - 1;
        const Place place = {surface, -lookup.direction, normal_towards(surface, -lookup.direction), most, i};
        Rgb light = {};
        if (!lookup.wants_all || !maps.global_has_all) light = estimate(maps.caustic, place);
        if (lookup.wants_all) light += estimate(maps.global, place);
        if (!is_black(light)) add_radiance(film, lookup.pixel, lookup.throughput * light);
    }

private:
    struct Place {
        const Surface& surface;
        Vec3 wo, normal;
        uint32_t most_scatterings, number;
    };

    HD static Vec3 normal_towards(const Surface& surface, Vec3 wo) {
        return dot(surface.geometric_normal, wo) < 0 ? -surface.geometric_normal : surface.geometric_normal;
    }
    /// f(wo, wi) power of photon `number`, W/sr.
    HD static Rgb sent_on(const PhotonMapView& map, const Place& place, uint32_t number) {
        const Float4 power = map.photons.powers[number], way = map.photons.ways[number];
        if (bits_of(power.w) > place.most_scatterings) return {};
        if (!(dot(unpack_normal(bits_of(way.w)), place.normal) > 0.7071f)) return {};
        const Vec3 wi = {way.x, way.y, way.z};
        const float cosine = abs(dot(wi, place.surface.geometric_normal));
        const Rgb f = place.surface.evaluate(place.wo, wi, only(LobeClass::Diffuse)).f;
        if (is_black(f) || !(cosine > 0)) return {};
        return (1.0f / cosine) * (f * Rgb{power.x, power.y, power.z});
    }

    HD Rgb estimate(const PhotonMapView& map, const Place& place) const {
        if (map.count == 0) return {};
        if (gather.nearest_count > 0) return of_nearest(map, place);
        FixedSum sums[3];
        visit_within(structure_of<kSearch>(map), place.surface.position, map.radius, [&](const NearPoint& near) {
            const Rgb light = sent_on(map, place, near.index);
            if (is_black(light)) return;
            if (!(max_component(light) <= kMaxSampleValue)) {
                atomic_add(film.invalid, 1);
                return;
            }
            sums[0] = sums[0] + to_fixed(light.r);
            sums[1] = sums[1] + to_fixed(light.g);
            sums[2] = sums[2] + to_fixed(light.b);
        });
        const Rgb all = {mean_of(sums[0], 1), mean_of(sums[1], 1), mean_of(sums[2], 1)};
        return (kInvPi / square(map.radius)) * all;
    }
    HD Rgb of_nearest(const PhotonMapView& map, const Place& place) const {
        NearPoint* nearest = gather.nearest + std::size_t(place.number) * gather.nearest_count;
        uint32_t count =
            find_nearest(structure_of<kSearch>(map), place.surface.position, map.radius, gather.nearest_count, nearest);
        float radius_squared = square(map.radius);
        if (count == gather.nearest_count) radius_squared = nearest[--count].distance_squared;
        if (!(radius_squared >= square(kLeastPhotonRadius))) return {}; // all in one place
        Rgb all = {};
        for (uint32_t k = 0; k < count; ++k) all += sent_on(map, place, nearest[k].index);
        return (kInvPi / radius_squared) * all;
    }
};

} // namespace pertev
