#pragma once

// The stages in their order, written once for both ways to run them (integrators/subpaths/run_walks.h).

#include "integrators/irradiance_cache/cache_stages.h"
#include "integrators/irradiance_cache/hemisphere_stages.h"
#include "integrators/irradiance_cache/overture_grid.h"
#include "integrators/subpaths/run_walks.h"

namespace pertev {

struct CacheJob {
    WalkJob walk;
    CacheWalksView cache;
    IrradianceCacheView records;
    bool shows_records;
    Rgb mark; // light of a record's mark
    uint64_t* missed;
    const MirroredLamps* mirrored;

    // Of the overture.
    OvertureGrid grid;
    uint32_t round;
    RecordSite* sites;
    // Of hemispheres.
    HemisphereJob hemispheres;
    IrradianceRecord* made;
};

/// What a job's walks are.
enum class CacheWalks : uint8_t { Picture, Overture, Hemispheres };

/// Walks that have begun, to their ends.
template <CacheWalks kWalks, class Way>
void run_cache_rounds(Way& way, const CacheJob& job) {
    const WalkJob& walk = job.walk;
    const WalksView& walks = walk.walks;
    constexpr bool kIsHemisphere = kWalks == CacheWalks::Hemispheres;
    const auto first = static_cast<uint32_t>(walk.first);
    way.begin_rounds(walk.count);
    for (uint32_t round = 0; round <= walk.scene.settings.max_depth && way.has_rays_left(walk); ++round) {
        const WorkCount rays = {way.most_rays(), &walks.counts->rays};
        const WorkCount asked = {way.most_rays(), &walks.counts->asked};
        const WorkCount lookups = {way.most_rays(), &walks.counts->vertices};
        way.find_hits(round == 0 && !kIsHemisphere ? RayKind::Camera : RayKind::Bounce, walk, rays, round);
        if (kIsHemisphere && round == 0) way.run("store_distances", rays, StoreDistances{walks, job.cache, first});
        with_known(walk.scene.picture.scene.known, [&]<MaterialsKnown kKnown>() {
            if (kWalks == CacheWalks::Picture && job.shows_records) {
                way.run("draw_records", rays,
                        DrawRecords<kKnown>{walk.scene, walks, job.cache, job.records, walk.film, job.mark, round});
            }
            way.run("shade_cache_walks", rays,
                    ShadeCacheWalks<kKnown>{walk.scene, walks, job.cache, walk.film, job.mirrored, kIsHemisphere, first,
                                            round});
            if (kWalks == CacheWalks::Picture) {
                way.run("look_up_light", lookups,
                        LookUpLight<kKnown>{walk.scene, walks, job.cache, job.records, walk.film, job.missed});
            } else if (kWalks == CacheWalks::Overture) {
                way.run("seek_places", lookups,
                        SeekPlaces<kKnown>{walk.scene, job.cache, job.records, job.sites, first});
            }
        });
        if (kWalks != CacheWalks::Overture) {
            way.find_connections(walk, asked);
            way.run("add_connections", asked, AddConnections{walks, walk.film});
        }
        way.run("count_walks", 1, CountWalks{walks.counts, true, 0});
    }
}

/// Samples [walk.first, + walk.count) of walk.samples.
template <class Way>
void run_picture(Way& way, const CacheJob& job) {
    const WalkJob& walk = job.walk;
    way.run("begin_walks", 1, BeginWalks{walk.walks.counts, walk.count});
    way.run("begin_cache_walks", walk.count,
            BeginCacheWalks{{walk.scene, walk.walks, walk.samples, walk.first}, job.cache});
    run_cache_rounds<CacheWalks::Picture>(way, job);
}

/// Numbers [walk.first, + walk.count) of the grid.
template <class Way>
void run_overture(Way& way, const CacheJob& job) {
    const WalkJob& walk = job.walk;
    way.run("begin_walks", 1, BeginWalks{walk.walks.counts, walk.count});
    way.run("begin_seekers", walk.count,
            BeginSeekers{walk.scene, walk.walks, job.cache, job.grid, job.sites, job.round,
                         static_cast<uint32_t>(walk.first)});
    run_cache_rounds<CacheWalks::Overture>(way, job);
}

/// Cells [walk.first, + walk.count) in memory.
template <class Way>
void run_hemispheres(Way& way, const CacheJob& job) {
    const WalkJob& walk = job.walk;
    way.run("begin_walks", 1, BeginWalks{walk.walks.counts, 0});
    with_known(walk.scene.picture.scene.known, [&]<MaterialsKnown kKnown>() {
        way.run("begin_hemispheres", walk.count,
                BeginHemispheres<kKnown>{walk.scene, walk.walks, job.cache, job.hemispheres,
                                         static_cast<uint32_t>(walk.first)});
    });
    way.run("count_walks", 1, CountWalks{walk.walks.counts, true, 0});
    run_cache_rounds<CacheWalks::Hemispheres>(way, job);
}

/// So many of the records whose cells are in memory, from the first one on.
template <class Way>
void finish_records(Way& way, const CacheJob& job, uint32_t count) {
    way.run("read_cells", count * job.hemispheres.grid.cells(), ReadCells{job.cache});
    with_known(job.walk.scene.picture.scene.known, [&]<MaterialsKnown kKnown>() {
        way.run("finish_records", count, FinishRecords<kKnown>{job.walk.scene, job.cache, job.hemispheres, job.made});
    });
}

} // namespace pertev
