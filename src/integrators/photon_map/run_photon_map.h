#pragma once

// Orders the stages of a pass once for both schedules (integrators/subpaths/run_subpaths.h).

#include "integrators/photon_map/gather_stages.h"
#include "integrators/photon_map/photon_stages.h"
#include "integrators/subpaths/run_subpaths.h"

namespace pertev {

struct PhotonJob : SubpathJob {
    using Capacity = GatherCapacity;

    GatherView gather;
    PhotonPass pass;
    PhotonMapsView maps; // for camera subpaths only
    PhotonMapView in_media;
    PhotonGather how;
    PhotonSearch search;
    float near; // metres, ShadeGather::near
};

inline std::size_t lay_out(PhotonJob& job, std::byte* memory, const GatherCapacity& capacity) {
    const std::size_t of_subpaths =
        lay_out(job.subpaths, memory, {capacity.count, 0, 1, capacity.has_interiors, capacity.has_normals});
    return of_subpaths + lay_out(job.gather, memory != nullptr ? memory + of_subpaths : nullptr, capacity);
}

/// Traces photons [job.first, + job.count) of the pass to their ends.
template <class Schedule>
void run_photons(Schedule& schedule, const PhotonJob& job) {
    const SubpathsView& subpaths = job.subpaths;
    schedule.run("begin_subpaths", 1, BeginSubpaths{subpaths.counts, 0});
    const SceneView& scene = job.scene.picture.scene;
    schedule.run("begin_photons", job.count,
                 BeginPhotons{job.scene, subpaths, job.gather, job.pass, static_cast<uint32_t>(job.first)});
    schedule.run("count_subpaths", 1, CountSubpaths{subpaths.counts, true, 0});
    schedule.begin_rounds(job.count);
    for (uint32_t round = 0; round < job.scene.settings.max_depth && schedule.has_rays_left(subpaths.counts); ++round) {
        const WorkCount rays = {schedule.max_rays(), &subpaths.counts->rays};
        schedule.find_hits(RayKind::Bounce, job, rays, round);
        with_media(scene, [&]<ShadingVariant kVariant, bool kInMedia>() {
            schedule.run("shade_photons", rays,
                         ShadePhotons<kVariant, kInMedia>{job.scene, subpaths, job.gather, job.pass, round});
        });
        schedule.run("count_subpaths", 1, CountSubpaths{subpaths.counts, true, 0});
    }
}

template <ShadingVariant kVariant, class Schedule>
void estimate_radiance(Schedule& schedule, const PhotonJob& job, WorkCount lookups) {
    const auto by = [&]<ShadingVariant kOf, PhotonSearch kSearch>() {
        const EstimateRadiance<kOf, kSearch> estimate = {job.scene, job.subpaths, job.gather, job.maps, job.film};
        schedule.run("estimate_radiance", lookups, estimate);
        if constexpr (kSearch == PhotonSearch::Grid) {
            if (job.gather.crowded == nullptr) return;
            const uint32_t sharing = min(lookups.most, kMaxSharing / kShares) * kShares;
            schedule.run("share_lookups", sharing, ShareLookups<kOf>{estimate, sharing});
            schedule.run("add_shared_lookups", {lookups.most, &job.subpaths.counts->crowded},
                         AddSharedLookups<kOf>{estimate});
        }
    };
    switch (job.search) {
    case PhotonSearch::Grid:
        return by.template operator()<kVariant, PhotonSearch::Grid>();
    case PhotonSearch::KdTree: // trees are for comparison, and have code for all materials alone
        return by.template operator()<ShadingVariant::General, PhotonSearch::KdTree>();
    case PhotonSearch::Octree:
        return by.template operator()<ShadingVariant::General, PhotonSearch::Octree>();
    }
}

/// Traces camera subpaths [job.first, + job.count) of the pass to their ends.
template <class Schedule>
void run_gather(Schedule& schedule, const PhotonJob& job) {
    const SubpathsView& subpaths = job.subpaths;
    schedule.run("begin_subpaths", 1, BeginSubpaths{subpaths.counts, job.count});
    schedule.run("begin_gather", job.count, BeginGather{{job.scene, subpaths, job.samples, job.first}, job.gather});
    schedule.begin_rounds(job.count);
    for (uint32_t round = 0; round <= job.scene.settings.max_depth && schedule.has_rays_left(subpaths.counts);
         ++round) {
        const WorkCount rays = {schedule.max_rays(), &subpaths.counts->rays};
        const WorkCount connections = {schedule.max_rays(), &subpaths.counts->connections};
        const WorkCount lookups = {schedule.max_rays(), &subpaths.counts->vertices};
        schedule.find_hits(round == 0 ? RayKind::Camera : RayKind::Bounce, job, rays, round);
        with_media_and_choice<true>(job.scene, [&]<ShadingVariant kVariant, bool kInMedia, class Choice>() {
            ShadeGather<kVariant, kInMedia, Choice> shade = {{},       job.scene, subpaths, job.gather,
                                                             job.film, job.how,   job.near, round};
            if constexpr (kInMedia) shade.in_media = job.in_media;
            schedule.run("shade_gather", rays, shade);
            estimate_radiance<kVariant>(schedule, job, lookups);
        });
        schedule.find_connections(job, connections);
        schedule.run("add_connections", connections, AddConnections{subpaths, job.film});
        schedule.run("count_subpaths", 1, CountSubpaths{subpaths.counts, true, 0});
    }
}

} // namespace pertev
