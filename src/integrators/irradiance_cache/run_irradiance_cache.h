#pragma once

// Orders the stages once for both schedules (integrators/subpaths/run_subpaths.h).

#include "integrators/irradiance_cache/cache_stages.h"
#include "integrators/irradiance_cache/hemisphere_stages.h"
#include "integrators/irradiance_cache/overture_grid.h"
#include "integrators/subpaths/run_subpaths.h"

namespace pertev {

struct CacheJob : SubpathJob {
    using Capacity = CacheCapacity;

    CacheSubpathsView cache;
    IrradianceCacheView records;
    bool shows_records;
    Rgb mark; // light of a record's mark
    uint64_t* missed;
    const MirroredEmitters* mirrored;

    // Used by the overture.
    OvertureGrid grid;
    uint32_t round;
    RecordSite* sites;
    // Used by hemispheres.
    HemisphereJob hemispheres;
    IrradianceRecord* made;
};

inline std::size_t lay_out(CacheJob& job, std::byte* memory, const CacheCapacity& capacity) {
    const std::size_t of_subpaths = lay_out(job.subpaths, memory, {capacity.count, 0, 1, false, capacity.has_normals});
    return of_subpaths + lay_out(job.cache, memory != nullptr ? memory + of_subpaths : nullptr, capacity);
}

/// Purpose of a job's paths.
enum class CacheSubpaths : uint8_t { Picture, Overture, Hemispheres };

/// Runs the paths that have begun to their ends.
template <CacheSubpaths kSubpaths, class Schedule>
void run_cache_rounds(Schedule& schedule, const CacheJob& job) {
    const SubpathsView& subpaths = job.subpaths;
    constexpr bool kIsHemisphere = kSubpaths == CacheSubpaths::Hemispheres;
    const auto first = static_cast<uint32_t>(job.first);
    schedule.begin_rounds(job.count);
    for (uint32_t round = 0; round <= job.scene.settings.max_depth && schedule.has_rays_left(subpaths.counts);
         ++round) {
        const WorkCount rays = {schedule.max_rays(), &subpaths.counts->rays};
        const WorkCount connections = {schedule.max_rays(), &subpaths.counts->connections};
        const WorkCount lookups = {schedule.max_rays(), &subpaths.counts->vertices};
        schedule.find_hits(round == 0 && !kIsHemisphere ? RayKind::Camera : RayKind::Bounce, job, rays, round);
        if (kIsHemisphere && round == 0)
            schedule.run("store_distances", rays, StoreDistances{subpaths, job.cache, first});
        with_choice<true>(job.scene, [&]<ShadingVariant kVariant, class Choice>() {
            if (kSubpaths == CacheSubpaths::Picture && job.shows_records) {
                schedule.run(
                    "draw_records", rays,
                    DrawRecords<kVariant>{job.scene, subpaths, job.cache, job.records, job.film, job.mark, round});
            }
            schedule.run("shade_cache_subpaths", rays,
                         ShadeCacheSubpaths<kVariant, Choice>{job.scene, subpaths, job.cache, job.film, job.mirrored,
                                                              kIsHemisphere, first, round});
            if (kSubpaths == CacheSubpaths::Picture) {
                schedule.run(
                    "look_up_light", lookups,
                    LookUpRadiance<kVariant>{job.scene, subpaths, job.cache, job.records, job.film, job.missed});
            } else if (kSubpaths == CacheSubpaths::Overture) {
                schedule.run("seek_places", lookups,
                             FindRecordSites<kVariant>{job.scene, job.cache, job.records, job.sites, first});
            }
        });
        if (kSubpaths != CacheSubpaths::Overture) {
            schedule.find_connections(job, connections);
            schedule.run("add_connections", connections, AddConnections{subpaths, job.film});
        }
        schedule.run("count_subpaths", 1, CountSubpaths{subpaths.counts, true, 0});
    }
}

/// Renders samples [job.first, + job.count) of job.samples.
template <class Schedule>
void run_picture(Schedule& schedule, const CacheJob& job) {
    schedule.run("begin_subpaths", 1, BeginSubpaths{job.subpaths.counts, job.count});
    schedule.run("begin_cache_subpaths", job.count,
                 BeginCacheSubpaths{{job.scene, job.subpaths, job.samples, job.first}, job.cache});
    run_cache_rounds<CacheSubpaths::Picture>(schedule, job);
}

/// Traces indices [job.first, + job.count) of the grid.
template <class Schedule>
void run_overture(Schedule& schedule, const CacheJob& job) {
    schedule.run("begin_subpaths", 1, BeginSubpaths{job.subpaths.counts, job.count});
    schedule.run("begin_seekers", job.count,
                 BeginSeekers{job.scene, job.subpaths, job.cache, job.grid, job.sites, job.round,
                              static_cast<uint32_t>(job.first)});
    run_cache_rounds<CacheSubpaths::Overture>(schedule, job);
}

/// Traces cells [job.first, + job.count) in memory.
template <class Schedule>
void run_hemispheres(Schedule& schedule, const CacheJob& job) {
    schedule.run("begin_subpaths", 1, BeginSubpaths{job.subpaths.counts, 0});
    with_plain_diffuse(job.scene.picture.scene.variant, [&]<ShadingVariant kVariant>() {
        schedule.run("begin_hemispheres", job.count,
                     BeginHemispheres<kVariant>{job.scene, job.subpaths, job.cache, job.hemispheres,
                                                static_cast<uint32_t>(job.first)});
    });
    schedule.run("count_subpaths", 1, CountSubpaths{job.subpaths.counts, true, 0});
    run_cache_rounds<CacheSubpaths::Hemispheres>(schedule, job);
}

/// Finishes the first `count` records whose cells are in memory.
template <class Schedule>
void finish_records(Schedule& schedule, const CacheJob& job, uint32_t count) {
    schedule.run("read_cells", count * job.hemispheres.grid.cells(), ReadCells{job.cache});
    with_plain_diffuse(job.scene.picture.scene.variant, [&]<ShadingVariant kVariant>() {
        schedule.run("finish_records", count, FinishRecords<kVariant>{job.scene, job.cache, job.hemispheres, job.made});
    });
}

} // namespace pertev
