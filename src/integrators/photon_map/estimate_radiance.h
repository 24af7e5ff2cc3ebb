#pragma once

// Estimates the light that a diffuse surface scatters from the photons near a point, within the radius r:
//     L = sum over photons of f(wo, wi) power / (pi r^2),
// where f is the BSDF of the diffuse lobes. Photons on surfaces turned away by more than 45 degrees belong to another
// wall and do not count, unless they are on the back of a surface that lets light through, nor do those of another
// owner (photon_map_view.h).
//
// Sources: Jensen, "Global Illumination using Photon Maps", 1996, section 5. Of the k nearest photons the farthest
// sets the radius and does not count itself, so that the mean is right for uniform photons (Loftsgaarden, Quesenberry
// 1965).
//
// Sums within a radius use integers, so they do not depend on the order in which a structure visits the photons; the
// k nearest are added in their order (distance, number). Thus all structures give the same bytes, and threads may
// share a lookup in a grid. The wavefront shares lookups where photons crowd, as under a glass ball; otherwise one
// GPU thread would still work on one long after all others.

#include "integrators/photon_map/gather_memory.h"
#include "integrators/photon_map/photon_map_view.h"
#include "integrators/subpaths/subpath_vertex.h"
#include "render/film_view.h"

namespace pertev {

/// The global and the caustic map of a pass.
struct PhotonMapsView {
    PhotonMapView global, caustic;
    bool global_has_all = false; // contains the caustic map's photons too
};

/// Number of photons in a lookup from which on threads share it.
inline constexpr uint32_t kCrowd = 128;
inline constexpr uint32_t kShares = 32;           // shares of such a lookup
inline constexpr uint32_t kMaxSharing = 1u << 18; // threads at once

/// The stage that evaluates all lookups. Those with many photons are left to be shared if GatherView has room for that.
template <ShadingVariant kVariant, PhotonSearch kSearch>
struct EstimateRadiance {
    SubpathScene scene;
    SubpathsView subpaths;
    GatherView gather;
    PhotonMapsView maps;
    FilmView film;

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const Lookup lookup = gather.load(i);
        const Surface surface = make_surface<kVariant>(scene.picture.scene, lookup.hit, lookup.direction);
        if (gather.nearest_count > 0) {
            const Receiver receiver = receiver_of(lookup, surface);
            Rgb light = {};
            if (needs_caustic(lookup)) light = of_nearest(maps.caustic, receiver, i);
            if (lookup.wants_all) light += of_nearest(maps.global, receiver, i);
            return add(lookup, light);
        }
        if (is_crowded(lookup, surface.position)) {
            const uint32_t at = atomic_add(&subpaths.counts->crowded, 1u);
            gather.crowded[at] = i;
            gather.shared_sums[at] = {};
            return;
        }
        GatheredSums sums;
        if (needs_caustic(lookup)) visit(maps.caustic, receiver_of(lookup, surface), sums.caustic);
        if (lookup.wants_all) visit(maps.global, receiver_of(lookup, surface), sums.global);
        add_sums(lookup, sums);
    }

    /// Adds a share of the lookup `gather.crowded[at]`.
    HD INLINE_ON_DEVICE void add_share(uint32_t at, Share share) const {
        const Lookup lookup = gather.load(gather.crowded[at]);
        const Surface surface = make_surface<kVariant>(scene.picture.scene, lookup.hit, lookup.direction);
        GatheredSums sums;
        if (needs_caustic(lookup)) visit(maps.caustic, receiver_of(lookup, surface), sums.caustic, share);
        if (lookup.wants_all) visit(maps.global, receiver_of(lookup, surface), sums.global, share);
        GatheredSums& all = gather.shared_sums[at];
        for (int c = 0; c < 3; ++c) {
            atomic_add(&all.caustic[c], sums.caustic[c]);
            atomic_add(&all.global[c], sums.global[c]);
        }
    }
    /// Adds the sums of a shared lookup to the film after all shares are done.
    HD void add_shared(uint32_t at) const { add_sums(gather.load(gather.crowded[at]), gather.shared_sums[at]); }

private:
    struct Receiver {
        const Surface& surface;
        Vec3 wo, normal;
        uint32_t max_scatterings, owner;
    };

    HD Receiver receiver_of(const Lookup& lookup, const Surface& surface) const {
        const Vec3 wo = -lookup.direction;
        // Maximum number of scatterings of a photon; the surface itself adds one.
        return {surface, wo, normal_towards(surface, wo), scene.settings.max_depth - lookup.scatterings - 1,
                owner_of(scene.picture.scene, lookup.hit.instance)};
    }
    HD bool needs_caustic(const Lookup& lookup) const { return !lookup.wants_all || !maps.global_has_all; }
    HD bool is_crowded(const Lookup& lookup, Vec3 at) const {
        if constexpr (kSearch != PhotonSearch::Grid) return false;
        if (gather.crowded == nullptr) return false;
        uint32_t count = 0;
        if (needs_caustic(lookup) && maps.caustic.count > 0) count += count_near(maps.caustic.grid, at);
        if (lookup.wants_all && maps.global.count > 0) count += count_near(maps.global.grid, at);
        return count >= kCrowd;
    }
    HD void add(const Lookup& lookup, Rgb light) const {
        if (!is_black(light)) add_radiance(film, lookup.pixel, lookup.throughput * light);
    }
    HD void add_sums(const Lookup& lookup, const GatheredSums& sums) const {
        Rgb light = {};
        if (needs_caustic(lookup)) light = radiance_of(maps.caustic, sums.caustic);
        if (lookup.wants_all) light += radiance_of(maps.global, sums.global);
        add(lookup, light);
    }

    HD static Vec3 normal_towards(const Surface& surface, Vec3 wo) {
        return dot(surface.geometric_normal, wo) < 0 ? -surface.geometric_normal : surface.geometric_normal;
    }
    /// Scattered power f(wo, wi) power of photon `number`, W/sr.
    HD static Rgb reflected_light(const PhotonMapView& map, const Receiver& receiver, uint32_t number) {
        const Float4 power = map.photons.powers[number], direction = map.photons.directions[number];
        if (PhotonsView::scatterings(power) > receiver.max_scatterings) return {};
        if (PhotonsView::owner(power) != receiver.owner) return {};
        const Vec3 wi = {direction.x, direction.y, direction.z};
        const float facing = dot(unpack_normal(bits_of(direction.w)), receiver.normal);
        const bool is_behind =
            facing < -0.7071f && receiver.surface.bsdf.lets_through() && dot(wi, receiver.normal) < 0;
        if (!(facing > 0.7071f) && !is_behind) return {};
        const float cosine = abs(dot(wi, receiver.surface.geometric_normal));
        const Rgb f = evaluate_surface<kVariant>(receiver.surface, receiver.wo, wi, only(LobeClass::Diffuse)).f;
        if (is_black(f) || !(cosine > 0)) return {};
        return (1.0f / cosine) * (f * Rgb{power.x, power.y, power.z});
    }

    /// Adds the scattered light of the photons in a share that are within the radius.
    HD void visit(const PhotonMapView& map, const Receiver& receiver, FixedSum* sums, Share share = {}) const {
        if (map.count == 0) return;
        const auto add_light = [&](const NearPoint& near) {
            const Rgb light = reflected_light(map, receiver, near.index);
            if (is_black(light)) return;
            if (!(max_component(light) <= kMaxSampleValue)) {
                atomic_add(film.invalid, 1);
                return;
            }
            sums[0] = sums[0] + to_fixed(light.r);
            sums[1] = sums[1] + to_fixed(light.g);
            sums[2] = sums[2] + to_fixed(light.b);
        };
        if constexpr (kSearch == PhotonSearch::Grid) {
            visit_within(map.grid, receiver.surface.position, map.radius, add_light, share);
        } else {
            visit_within(structure_of<kSearch>(map), receiver.surface.position, map.radius, add_light);
        }
    }
    HD static Rgb radiance_of(const PhotonMapView& map, const FixedSum* sums) {
        if (map.count == 0) return {};
        return (kInvPi / square(map.radius)) * Rgb{mean_of(sums[0], 1), mean_of(sums[1], 1), mean_of(sums[2], 1)};
    }
    HD Rgb of_nearest(const PhotonMapView& map, const Receiver& receiver, uint32_t number) const {
        if (map.count == 0) return {};
        NearPoint* nearest = gather.nearest + std::size_t(number) * gather.nearest_count;
        uint32_t count = find_nearest(structure_of<kSearch>(map), receiver.surface.position, map.radius,
                                      gather.nearest_count, nearest);
        float radius_squared = square(map.radius);
        if (count == gather.nearest_count) radius_squared = nearest[--count].distance_squared;
        if (!(radius_squared >= square(kMinPhotonRadius))) return {}; // all at one point
        Rgb all = {};
        for (uint32_t k = 0; k < count; ++k) all += reflected_light(map, receiver, nearest[k].index);
        return (kInvPi / radius_squared) * all;
    }
};

/// The stage that shares the lookups with many photons among threads: thread i takes share i % kShares of lookups i /
/// kShares, i / kShares + sharing / kShares, ...
template <ShadingVariant kVariant>
struct ShareLookups {
    EstimateRadiance<kVariant, PhotonSearch::Grid> estimate;
    uint32_t sharing; // number of threads, a multiple of kShares

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const uint32_t crowded = estimate.subpaths.counts->crowded;
        for (uint32_t at = i / kShares; at < crowded; at += sharing / kShares) {
            estimate.add_share(at, {i % kShares, kShares});
        }
    }
};

/// The stage that adds the shared lookups to the film.
template <ShadingVariant kVariant>
struct AddSharedLookups {
    EstimateRadiance<kVariant, PhotonSearch::Grid> estimate;

    HD void operator()(uint32_t at) const { estimate.add_shared(at); }
};

} // namespace pertev
