#pragma once

// Orders the stages of a pass once for both schedules (integrators/subpaths/run_walks.h).

#include "integrators/photon_map/gather_stages.h"
#include "integrators/photon_map/photon_stages.h"
#include "integrators/subpaths/run_walks.h"

namespace pertev {

struct PhotonJob : WalkJob {
    using Room = GatherRoom;

    GatherView gather;
    PhotonPass pass;
    PhotonMapsView maps; // for camera subpaths only
    PhotonGather how;
    PhotonSearch search;
    float near; // metres, ShadeSights::near
};

inline std::size_t lay_out(PhotonJob& job, std::byte* memory, const GatherRoom& room) {
    const std::size_t of_walks = lay_out(job.walks, memory, {room.count, 0, 1});
    return of_walks + lay_out(job.gather, memory != nullptr ? memory + of_walks : nullptr, room);
}

/// Traces photons [job.first, + job.count) of the pass to their ends.
template <class Way>
void run_photons(Way& way, const PhotonJob& job) {
    const WalksView& walks = job.walks;
    way.run("begin_walks", 1, BeginWalks{walks.counts, 0});
    way.run("begin_photons", job.count,
            BeginPhotons{job.scene, walks, job.gather, job.pass, static_cast<uint32_t>(job.first)});
    way.run("count_walks", 1, CountWalks{walks.counts, true, 0});
    way.begin_rounds(job.count);
    for (uint32_t round = 0; round < job.scene.settings.max_depth && way.has_rays_left(walks.counts); ++round) {
        const WorkCount rays = {way.most_rays(), &walks.counts->rays};
        way.find_hits(RayKind::Bounce, job, rays, round);
        with_known(job.scene.picture.scene.known, [&]<MaterialsKnown kKnown>() {
            way.run("shade_photons", rays, ShadePhotons<kKnown>{job.scene, walks, job.gather, job.pass, round});
        });
        way.run("count_walks", 1, CountWalks{walks.counts, true, 0});
    }
}

template <MaterialsKnown kKnown, class Way>
void estimate_radiance(Way& way, const PhotonJob& job, WorkCount lookups) {
    const auto by = [&]<PhotonSearch kSearch>() {
        const EstimateRadiance<kKnown, kSearch> estimate = {job.scene, job.walks, job.gather, job.maps, job.film};
        way.run("estimate_radiance", lookups, estimate);
        if constexpr (kSearch == PhotonSearch::Grid) {
            if (job.gather.crowded == nullptr) return;
            const uint32_t sharing = min(lookups.most, kMostSharing / kShares) * kShares;
            way.run("share_lookups", sharing, ShareLookups<kKnown>{estimate, sharing});
            way.run("add_shared_lookups", {lookups.most, &job.walks.counts->crowded},
                    AddSharedLookups<kKnown>{estimate});
        }
    };
    switch (job.search) {
    case PhotonSearch::Grid:
        return by.template operator()<PhotonSearch::Grid>();
    case PhotonSearch::KdTree:
        return by.template operator()<PhotonSearch::KdTree>();
    case PhotonSearch::Octree:
        return by.template operator()<PhotonSearch::Octree>();
    }
}

/// Traces camera subpaths [job.first, + job.count) of the pass to their ends.
template <class Way>
void run_sights(Way& way, const PhotonJob& job) {
    const WalksView& walks = job.walks;
    way.run("begin_walks", 1, BeginWalks{walks.counts, job.count});
    way.run("begin_sights", job.count, BeginSights{{job.scene, walks, job.samples, job.first}, job.gather});
    way.begin_rounds(job.count);
    for (uint32_t round = 0; round <= job.scene.settings.max_depth && way.has_rays_left(walks.counts); ++round) {
        const WorkCount rays = {way.most_rays(), &walks.counts->rays};
        const WorkCount asked = {way.most_rays(), &walks.counts->asked};
        const WorkCount lookups = {way.most_rays(), &walks.counts->vertices};
        way.find_hits(round == 0 ? RayKind::Camera : RayKind::Bounce, job, rays, round);
        with_known(job.scene.picture.scene.known, [&]<MaterialsKnown kKnown>() {
            way.run("shade_sights", rays,
                    ShadeSights<kKnown>{job.scene, walks, job.gather, job.film, job.how, job.near, round});
            estimate_radiance<kKnown>(way, job, lookups);
        });
        way.find_connections(job, asked);
        way.run("add_connections", asked, AddConnections{walks, job.film});
        way.run("count_walks", 1, CountWalks{walks.counts, true, 0});
    }
}

} // namespace pertev
