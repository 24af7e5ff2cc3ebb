#pragma once

// Stages that handle lookups of camera paths. In a picture they add light, or let the path continue without it; in
// the overture, before the picture, they request a record if there is none.

#include "integrators/irradiance_cache/cache_memory.h"
#include "integrators/irradiance_cache/irradiance_record.h"
#include "integrators/subpaths/subpath_vertex.h"
#include "render/film_view.h"
#include "render/first_hit.h"

namespace pertev {

/// The stage of lookup i of a picture.
template <ShadingVariant kVariant>
struct LookUpRadiance {
    SubpathScene scene;
    SubpathsView subpaths;
    CacheSubpathsView cache;
    IrradianceCacheView records;
    FilmView film;
    uint64_t* missed; // lookups without a record

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const CacheLookup lookup = cache.load(i);
        const Vec3 wo = -lookup.direction;
        const Surface surface = make_surface<kVariant>(scene.picture.scene, lookup.hit, lookup.direction);
        const CachedSurface cached(surface, wo);
        const CachedLight found = look_up(records, cache_point(surface, cached.side, lookup.scatterings));
        SubpathState& state = subpaths.states[lookup.subpath];
        if (found.weight > 0) {
            add_radiance(film, state.pixel, lookup.throughput * reflected_light(surface, wo, cached.side, found.light));
            return;
        }
        atomic_add(missed, 1);
        const CacheState cache_state = cache.cache_state_of(lookup.subpath);
        if (cache_state.pdf > 0) state.throughput = cache_state.seen;
    }
};

inline constexpr uint32_t kNoSite = 0xffffffffu;

/// A point for which a record is requested.
struct alignas(16) RecordSite {
    Vec3 direction = {}; // direction of the path that hit it, unit
    float distance = 0;  // distance from the camera, metres
    float u = 0, v = 0;  // on the triangle
    uint32_t instance = 0, primitive = 0;
    uint32_t scatterings = kNoSite; // between the camera and the point; kNoSite: no record is requested
    uint32_t unused[3] = {};
};

/// Total weight of the existing records below which the overture requests a record, because near the end of their range
/// other samples of the pixel would find none.
inline constexpr float kServedWeight = 0.25f;

/// The stage of lookup i of a round of the overture; each of its paths has a site, from `first` on.
template <ShadingVariant kVariant>
struct FindRecordSites {
    SubpathScene scene;
    CacheSubpathsView cache;
    IrradianceCacheView records;
    RecordSite* sites;
    uint32_t first;

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const CacheLookup lookup = cache.load(i);
        const Vec3 wo = -lookup.direction;
        const Surface surface = make_surface<kVariant>(scene.picture.scene, lookup.hit, lookup.direction);
        const CachedSurface cached(surface, wo);
        if (is_black(surface.bsdf.diffuse_albedo())) return;
        const CachedLight found = look_up(records, cache_point(surface, cached.side, lookup.scatterings));
        if (found.weight >= kServedWeight) return;
        cache.aims[lookup.subpath] = SubpathAim::End;
        const Hit& hit = lookup.hit;
        sites[first + lookup.subpath] = {lookup.direction, lookup.distance,    hit.u, hit.v, hit.instance,
                                         hit.primitive,    lookup.scatterings, {}};
    }
};

/// The stage that ends the path if ray i of a picture hits the mark of a record, and shows the mark.
template <ShadingVariant kVariant>
struct DrawRecords {
    static constexpr float kPixels = 1.25f; // radius of a mark

    SubpathScene scene;
    SubpathsView subpaths;
    CacheSubpathsView cache;
    IrradianceCacheView records;
    FilmView film;
    Rgb light; // light of marks, W/(sr m2)
    uint32_t round;

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const uint32_t subpath = subpaths.owners[round % 2][i];
        const Hit hit = subpaths.hits().load(i);
        if (cache.aims[subpath] != SubpathAim::Seek || hit.instance == kNoHit) return;
        const Ray ray = load_ray(subpaths.rays[round % 2] + i);
        const Surface surface = make_surface<kVariant>(scene.picture.scene, hit, ray.direction);
        const SubpathState& state = subpaths.states[subpath];
        const CachedSurface cached(surface, -ray.direction);
        if (!cached.is_cached) return;
        const CachePoint point = cache_point(surface, cached.side, state.depth());
        const float radius = kPixels * pixel_size(scene.picture.camera.view, cache.distances[subpath] + hit.t);
        bool is_marked = false;
        visit_within(records.tree, point.position, radius, [&](const NearPoint& near) {
            const CachePoint& own = records.records[near.index].point;
            is_marked = is_marked || (own.scatterings == point.scatterings && dot(own.normal, point.normal) > 0);
        });
        if (!is_marked) return;
        if (state.depth() == 0) {
            add_first_hit(film, state.pixel, state.sample, {ray.origin, ray.direction}, hit, surface, scene.picture);
        }
        add_radiance(film, state.pixel, state.throughput * light);
        cache.aims[subpath] = SubpathAim::End;
    }
};

} // namespace pertev
