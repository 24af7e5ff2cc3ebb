#pragma once

// The stages of a pass in their order, written once for both ways to run them (integrators/subpaths/run_walks.h).

#include "integrators/photon_map/gather_stages.h"
#include "integrators/photon_map/photon_stages.h"
#include "integrators/subpaths/run_walks.h"

namespace pertev {

struct PhotonJob {
    WalkJob walk;
    GatherView gather;
    PhotonPass pass;
    PhotonMapsView maps; // of the walks from the camera alone
    PhotonGather how;
    PhotonSearch search;
    float near; // metres, ShadeSights::near
};

/// Photons [walk.first, + walk.count) of the pass to their ends.
template <class Way>
void run_photons(Way& way, const PhotonJob& job) {
    const WalkJob& walk = job.walk;
    const WalksView& walks = walk.walks;
    way.run("begin_walks", 1, BeginWalks{walks.counts, 0});
    way.run("begin_photons", walk.count,
            BeginPhotons{walk.scene, walks, job.gather, job.pass, static_cast<uint32_t>(walk.first)});
    way.run("count_walks", 1, CountWalks{walks.counts, true, 0});
    way.begin_rounds(walk.count);
    for (uint32_t round = 0; round < walk.scene.settings.max_depth && way.has_rays_left(walk); ++round) {
        const WorkCount rays = {way.most_rays(), &walks.counts->rays};
        way.find_hits(RayKind::Bounce, walk, rays, round);
        with_known(walk.scene.picture.scene.known, [&]<MaterialsKnown kKnown>() {
            way.run("shade_photons", rays, ShadePhotons<kKnown>{walk.scene, walks, job.gather, job.pass, round});
        });
        way.run("count_walks", 1, CountWalks{walks.counts, true, 0});
    }
}

template <MaterialsKnown kKnown, class Way>
void estimate_radiance(Way& way, const PhotonJob& job, WorkCount lookups) {
    const auto by = [&]<PhotonSearch kSearch>() {
        const EstimateRadiance<kKnown, kSearch> estimate = {job.walk.scene, job.walk.walks, job.gather, job.maps,
                                                            job.walk.film};
        way.run("estimate_radiance", lookups, estimate);
        if constexpr (kSearch == PhotonSearch::Grid) {
            if (job.gather.crowded == nullptr) return;
            const uint32_t sharing = min(lookups.most, kMostSharing / kShares) * kShares;
            way.run("share_lookups", sharing, ShareLookups<kKnown>{estimate, sharing});
            way.run("add_shared_lookups", {lookups.most, &job.walk.walks.counts->crowded},
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

/// Walks from the camera, [walk.first, + walk.count) of the pass, to their ends.
template <class Way>
void run_sights(Way& way, const PhotonJob& job) {
    const WalkJob& walk = job.walk;
    const WalksView& walks = walk.walks;
    way.run("begin_walks", 1, BeginWalks{walks.counts, walk.count});
    way.run("begin_sights", walk.count, BeginSights{{walk.scene, walks, walk.samples, walk.first}, job.gather});
    way.begin_rounds(walk.count);
    for (uint32_t round = 0; round <= walk.scene.settings.max_depth && way.has_rays_left(walk); ++round) {
        const WorkCount rays = {way.most_rays(), &walks.counts->rays};
        const WorkCount asked = {way.most_rays(), &walks.counts->asked};
        const WorkCount lookups = {way.most_rays(), &walks.counts->vertices};
        way.find_hits(round == 0 ? RayKind::Camera : RayKind::Bounce, walk, rays, round);
        with_known(walk.scene.picture.scene.known, [&]<MaterialsKnown kKnown>() {
            way.run("shade_sights", rays,
                    ShadeSights<kKnown>{walk.scene, walks, job.gather, walk.film, job.how, job.near, round});
            estimate_radiance<kKnown>(way, job, lookups);
        });
        way.find_connections(walk, asked);
        way.run("add_connections", asked, AddConnections{walks, walk.film});
        way.run("count_walks", 1, CountWalks{walks.counts, true, 0});
    }
}

template <class Way>
void run_walks_of(Way& way, const PhotonJob& job, bool are_photons) {
    if (are_photons) return run_photons(way, job);
    run_sights(way, job);
}

} // namespace pertev
