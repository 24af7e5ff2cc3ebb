#pragma once

// Orders the stages once for both schedules (integrators/subpaths/run_walks.h).

#include "integrators/irradiance_cache/cache_stages.h"
#include "integrators/irradiance_cache/hemisphere_stages.h"
#include "integrators/irradiance_cache/overture_grid.h"
#include "integrators/subpaths/run_walks.h"

namespace pertev {

struct CacheJob : WalkJob {
    using Room = CacheRoom;

    CacheWalksView cache;
    IrradianceCacheView records;
    bool shows_records;
    Rgb mark; // light of a record's mark
    uint64_t* missed;
    const MirroredLamps* mirrored;

    // Used by the overture.
    OvertureGrid grid;
    uint32_t round;
    RecordSite* sites;
    // Used by hemispheres.
    HemisphereJob hemispheres;
    IrradianceRecord* made;
};

inline std::size_t lay_out(CacheJob& job, std::byte* memory, const CacheRoom& room) {
    const std::size_t of_walks = lay_out(job.walks, memory, {room.count, 0, 1});
    return of_walks + lay_out(job.cache, memory != nullptr ? memory + of_walks : nullptr, room);
}

/// Purpose of a job's paths.
enum class CacheWalks : uint8_t { Picture, Overture, Hemispheres };

/// Runs the paths that have begun to their ends.
template <CacheWalks kWalks, class Way>
void run_cache_rounds(Way& way, const CacheJob& job) {
    const WalksView& walks = job.walks;
    constexpr bool kIsHemisphere = kWalks == CacheWalks::Hemispheres;
    const auto first = static_cast<uint32_t>(job.first);
    way.begin_rounds(job.count);
    for (uint32_t round = 0; round <= job.scene.settings.max_depth && way.has_rays_left(walks.counts); ++round) {
        const WorkCount rays = {way.most_rays(), &walks.counts->rays};
        const WorkCount asked = {way.most_rays(), &walks.counts->asked};
        const WorkCount lookups = {way.most_rays(), &walks.counts->vertices};
        way.find_hits(round == 0 && !kIsHemisphere ? RayKind::Camera : RayKind::Bounce, job, rays, round);
        if (kIsHemisphere && round == 0) way.run("store_distances", rays, StoreDistances{walks, job.cache, first});
        with_known(job.scene.picture.scene.known, [&]<MaterialsKnown kKnown>() {
            if (kWalks == CacheWalks::Picture && job.shows_records) {
                way.run("draw_records", rays,
                        DrawRecords<kKnown>{job.scene, walks, job.cache, job.records, job.film, job.mark, round});
            }
            way.run("shade_cache_walks", rays,
                    ShadeCacheWalks<kKnown>{job.scene, walks, job.cache, job.film, job.mirrored, kIsHemisphere, first,
                                            round});
            if (kWalks == CacheWalks::Picture) {
                way.run("look_up_light", lookups,
                        LookUpLight<kKnown>{job.scene, walks, job.cache, job.records, job.film, job.missed});
            } else if (kWalks == CacheWalks::Overture) {
                way.run("seek_places", lookups,
                        SeekPlaces<kKnown>{job.scene, job.cache, job.records, job.sites, first});
            }
        });
        if (kWalks != CacheWalks::Overture) {
            way.find_connections(job, asked);
            way.run("add_connections", asked, AddConnections{walks, job.film});
        }
        way.run("count_walks", 1, CountWalks{walks.counts, true, 0});
    }
}

/// Renders samples [job.first, + job.count) of job.samples.
template <class Way>
void run_picture(Way& way, const CacheJob& job) {
    way.run("begin_walks", 1, BeginWalks{job.walks.counts, job.count});
    way.run("begin_cache_walks", job.count, BeginCacheWalks{{job.scene, job.walks, job.samples, job.first}, job.cache});
    run_cache_rounds<CacheWalks::Picture>(way, job);
}

/// Traces indices [job.first, + job.count) of the grid.
template <class Way>
void run_overture(Way& way, const CacheJob& job) {
    way.run("begin_walks", 1, BeginWalks{job.walks.counts, job.count});
    way.run("begin_seekers", job.count,
            BeginSeekers{job.scene, job.walks, job.cache, job.grid, job.sites, job.round,
                         static_cast<uint32_t>(job.first)});
    run_cache_rounds<CacheWalks::Overture>(way, job);
}

/// Traces cells [job.first, + job.count) in memory.
template <class Way>
void run_hemispheres(Way& way, const CacheJob& job) {
    way.run("begin_walks", 1, BeginWalks{job.walks.counts, 0});
    with_known(job.scene.picture.scene.known, [&]<MaterialsKnown kKnown>() {
        way.run("begin_hemispheres", job.count,
                BeginHemispheres<kKnown>{job.scene, job.walks, job.cache, job.hemispheres,
                                         static_cast<uint32_t>(job.first)});
    });
    way.run("count_walks", 1, CountWalks{job.walks.counts, true, 0});
    run_cache_rounds<CacheWalks::Hemispheres>(way, job);
}

/// Finishes the first `count` records whose cells are in memory.
template <class Way>
void finish_records(Way& way, const CacheJob& job, uint32_t count) {
    way.run("read_cells", count * job.hemispheres.grid.cells(), ReadCells{job.cache});
    with_known(job.scene.picture.scene.known, [&]<MaterialsKnown kKnown>() {
        way.run("finish_records", count, FinishRecords<kKnown>{job.scene, job.cache, job.hemispheres, job.made});
    });
}

} // namespace pertev
