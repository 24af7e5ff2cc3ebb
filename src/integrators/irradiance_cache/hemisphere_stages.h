#pragma once

// The stages that make records of places: a walk from each cell of a place's hemisphere, then the sum over the cells.

#include "integrators/irradiance_cache/cache_memory.h"
#include "integrators/irradiance_cache/cached_surface.h"
#include "integrators/irradiance_cache/hemisphere.h"
#include "integrators/irradiance_cache/lookup_stages.h"
#include "integrators/subpaths/walk_vertex.h"

namespace pertev {

/// Records of a picture that are to be made.
struct HemisphereJob {
    const RecordSite* sites; // of these records
    uint32_t first_record;   // the number of the first one, in the picture
    uint32_t begin;          // the first whose cells lie in memory
    HemisphereGrid grid;
};

HD inline Hit hit_of(const RecordSite& site) { return {0, site.u, site.v, site.instance, site.primitive}; }

/// Walks 0, 1, ... become those of cells `first`, first + 1, ... in memory.
template <MaterialsKnown kKnown>
struct BeginHemispheres {
    WalkScene scene;
    WalksView walks;
    CacheWalksView cache;
    HemisphereJob job;
    uint32_t first;

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const uint32_t at = first + i, cells = job.grid.cells();
        const uint32_t number = job.begin + at / cells, cell = at % cells;
        cache.cells[at] = {0, 0, 0, kInfinity};
        const RecordSite site = job.sites[number];
        const Surface surface = make_surface<kKnown>(scene.picture.scene, hit_of(site), site.direction);
        const float side = CachedSurface(surface, -site.direction).side;
        WalkState state = {};
        state.pixel = job.first_record + number;
        state.sample = cell;
        state.scatterings = static_cast<uint16_t>(site.scatterings + 1);
        const SampleKey key = {state.pixel, state.sample, scene.settings.seed};
        Vec3 local = direction_in_cell(job.grid, cell, sample_2d(SamplerKind::Independent, key, kGroupCamera));
        local.z = side * local.z;
        state.throughput = grey(let_in(surface.bsdf, side, local));
        if (surface.tilt > 0) local = raise_direction(local, surface.tilt).direction;
        const Vec3 wi = normalize(surface.frame.to_world(local));
        const bool is_before = (dot(surface.geometric_normal, wi) > 0) == (side > 0);
        if (!is_before || is_black(state.throughput)) return;
        walks.states[i] = state;
        // What is seen straight or by mirrors is not the record's, nor are lamps that later bounces see by mirrors.
        cache.store_sight(i, {{0, 0, 0}, 0});
        cache.store_path(i, {0, 0, 0});
        cache.ways[i] = 0;
        cache.aims[i] = WalkAim::GoOn;
        const Ray ray = {offset_ray_origin(surface.position, surface.error, surface.geometric_normal, wi), 0, wi,
                         kInfinity};
        walks.queue_ray(atomic_add(&walks.counts->next, 1u), i, ray, surface.triangle,
                        coin_key(key, site.scatterings, false), 0);
    }
};

/// What ray i of a first round has met is so far away.
struct StoreDistances {
    WalksView walks;
    CacheWalksView cache;
    uint32_t first;

    HD void operator()(uint32_t i) const {
        const Hit hit = walks.hits().load(i);
        if (hit.instance != kNoHit) cache.cells[first + walks.owners[0][i]].w = hit.t;
    }
};

/// The sums of cell i in memory become floats.
struct ReadCells {
    CacheWalksView cache;

    HD void operator()(uint32_t i) const {
        const FixedSum* light = cache.light + 3 * std::size_t(i);
        const float distance = cache.cells[i].w;
        cache.cells[i] = {mean_of(light[0], 1), mean_of(light[1], 1), mean_of(light[2], 1), distance};
    }
};

/// In pixels: a record's radius is no smaller and no larger (Tabellion and Lamorlette 2004, section 4.2).
inline constexpr float kLeastPixels = 16, kMostPixels = 400;

/// Record i of those whose cells lie in memory.
template <MaterialsKnown kKnown>
struct FinishRecords {
    WalkScene scene;
    CacheWalksView cache;
    HemisphereJob job;
    IrradianceRecord* records; // of the picture

    HD INLINE_ON_DEVICE void operator()(uint32_t i) const {
        const RecordSite site = job.sites[job.begin + i];
        const Surface surface = make_surface<kKnown>(scene.picture.scene, hit_of(site), site.direction);
        const float side = CachedSurface(surface, -site.direction).side;
        const float pixel = pixel_size(scene.picture.camera.view, site.way);
        const std::size_t first = std::size_t(i) * job.grid.cells();
        const float nearest = 0x1p-6f * pixel; // what is nearer counts as so near
        HemisphereSum sum = sum_hemisphere(job.grid, surface.frame, [&](uint32_t cell) {
            const Float4 c = cache.cells[first + cell];
            return HemisphereCell{{c.x, c.y, c.z}, max(c.w, nearest)};
        });
        limit_radius(sum, kLeastPixels * pixel, kMostPixels * pixel);
        IrradianceRecord record;
        record.place = place_of(surface, side, site.scatterings);
        record.radius = sum.radius;
        record.light = sum.light;
        for (int k = 0; k < 3; ++k) {
            record.by_turn[k] = sum.by_turn[k];
            record.by_move[k] = sum.by_move[k];
        }
        records[job.first_record + job.begin + i] = record;
    }
};

} // namespace pertev
