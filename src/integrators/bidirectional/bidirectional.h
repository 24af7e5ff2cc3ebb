#pragma once

// Bidirectional path tracing: a camera subpath and a light subpath. Every vertex of the camera subpath connects to
// every vertex of the light subpath and to a sampled light, and every vertex of the light subpath connects to the
// camera. A light path with k scatterings is found by k + 2 techniques, each weighted by MIS.
//
// Sources: Lafortune, Willems, "Bi-Directional Path Tracing", Compugraphics 1993; Veach, "Robust Monte Carlo Methods
// for Light Transport Simulation", 1997, chapter 10. Weights: integrators/subpaths/walk_memory.h.
//
// It finds all light that path tracing finds, L(D|G|S)*E, with less noise if light reaches the visible surfaces
// through narrow paths. Neither finds a point light that is seen only through clear glass or mirrors, because L S* D
// S* E then has no vertex to sample.

#include "integrators/bidirectional/eye_stages.h"
#include "integrators/subpaths/run_walks.h"

namespace pertev {

struct BothDirections {
    static constexpr bool kIsJoined = true;
    static WalkRoom room(const SubpathSettings& settings, uint32_t walks) {
        const uint32_t kept = settings.max_depth > 1 ? settings.max_depth - 1 : 1;
        return {walks, kept, kept < kJoinedAtOnce ? kept : kJoinedAtOnce};
    }

    template <class Way>
    static void render(Way& way, const WalkJob& job) {
        run_particles(way, job);
        const WalksView& walks = job.walks;
        const uint32_t depth = job.scene.settings.max_depth;
        way.run("begin_walks", 1, BeginWalks{walks.counts, job.count});
        way.run("begin_eyes", job.count, BeginEyes{job.scene, walks, job.samples, job.first});
        way.begin_rounds(job.count);
        for (uint32_t round = 0; round <= depth && way.has_rays_left(walks.counts); ++round) {
            with_known(job.scene.picture.scene.known,
                       [&]<MaterialsKnown kKnown>() { run_round<kKnown>(way, job, round); });
        }
    }

private:
    template <MaterialsKnown kKnown, class Way>
    static void run_round(Way& way, const WalkJob& job, uint32_t round) {
        const WalksView& walks = job.walks;
        const uint32_t most = way.most_rays(), depth = job.scene.settings.max_depth;
        const WorkCount rays = {most, &walks.counts->rays};
        way.find_hits(round == 0 ? RayKind::Camera : RayKind::Bounce, job, rays, round);
        way.run("shade_eyes", rays, ShadeEyes<kKnown>{job.scene, walks, job.film, round});
        add_connections(way, job, most, kJoinedAtOnce);
        for (uint32_t first = 0; round + first + 2 <= depth; first += kJoinedAtOnce) {
            const uint32_t pairs = most * kJoinedAtOnce;
            way.run("join_walks", {pairs, &walks.counts->pairs}, JoinWalks<kKnown>{job.scene, walks, first, round});
            add_connections(way, job, pairs, kJoinedAtOnce);
        }
        way.run("count_walks", 1, CountWalks{walks.counts, true, 0});
    }
    template <class Way>
    static void add_connections(Way& way, const WalkJob& job, uint32_t most, uint32_t joined) {
        const WorkCount asked = {most, &job.walks.counts->asked};
        way.find_connections(job, asked);
        way.run("add_connections", asked, AddConnections{job.walks, job.film});
        way.run("count_walks", 1, CountWalks{job.walks.counts, false, joined});
    }
};

} // namespace pertev
