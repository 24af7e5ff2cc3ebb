#pragma once

// Bidirectional path tracing: a camera subpath and a light subpath. Every vertex of the camera subpath connects to
// every vertex of the light subpath and to a sampled light, and every vertex of the light subpath connects to the
// camera. A light path with k scatterings is found by k + 2 techniques, each weighted by MIS.
//
// Sources: Lafortune, Willems, "Bi-Directional Path Tracing", Compugraphics 1993; Veach, "Robust Monte Carlo Methods
// for Light Transport Simulation", 1997, chapter 10. Weights: integrators/subpaths/subpath_memory.h.
//
// It finds all light that path tracing finds, L(D|G|S)*E, with less noise if light reaches the visible surfaces
// through narrow paths. Neither finds a point light that is visible only through clear glass or mirrors, because L S* D
// S* E then has no vertex to sample.

#include "integrators/bidirectional/camera_subpath_stages.h"
#include "integrators/subpaths/run_subpaths.h"

namespace pertev {

struct BothDirections {
    static constexpr bool kIsConnected = true;
    static SubpathCapacity capacity(const SubpathSettings& settings, uint32_t subpaths) {
        const uint32_t kept = settings.max_depth > 1 ? settings.max_depth - 1 : 1;
        return {subpaths, kept, kept < kConnectedAtOnce ? kept : kConnectedAtOnce};
    }

    template <class Schedule>
    static void render(Schedule& schedule, const SubpathJob& job) {
        run_particles<kIsConnected>(schedule, job);
        const SubpathsView& subpaths = job.subpaths;
        const uint32_t depth = job.scene.settings.max_depth;
        schedule.run("begin_subpaths", 1, BeginSubpaths{subpaths.counts, job.count});
        schedule.run("begin_camera_subpaths", job.count,
                     BeginCameraSubpaths{job.scene, subpaths, job.samples, job.first});
        schedule.begin_rounds(job.count);
        for (uint32_t round = 0; round <= depth && schedule.has_rays_left(subpaths.counts); ++round) {
            with_media_and_choice(job.scene, [&]<ShadingVariant kVariant, bool kInMedia, class Choice>() {
                run_round<kVariant, kInMedia, Choice>(schedule, job, round);
            });
        }
    }

private:
    template <ShadingVariant kVariant, bool kInMedia, class Choice, class Schedule>
    static void run_round(Schedule& schedule, const SubpathJob& job, uint32_t round) {
        const SubpathsView& subpaths = job.subpaths;
        const uint32_t most = schedule.max_rays(), depth = job.scene.settings.max_depth;
        const WorkCount rays = {most, &subpaths.counts->rays};
        schedule.find_hits(round == 0 ? RayKind::Camera : RayKind::Bounce, job, rays, round);
        schedule.run("shade_camera_subpaths", rays,
                     ShadeCameraSubpaths<kVariant, kInMedia, Choice>{job.scene, subpaths, job.film, round});
        add_connections(schedule, job, most, kConnectedAtOnce);
        for (uint32_t first = 0; round + first + 2 <= depth; first += kConnectedAtOnce) {
            const uint32_t pairs = most * kConnectedAtOnce;
            schedule.run("connect_subpaths", {pairs, &subpaths.counts->pairs},
                         ConnectSubpaths<kVariant, kInMedia>{job.scene, subpaths, first, round});
            add_connections(schedule, job, pairs, kConnectedAtOnce);
        }
        schedule.run("count_subpaths", 1, CountSubpaths{subpaths.counts, true, 0});
    }
    template <class Schedule>
    static void add_connections(Schedule& schedule, const SubpathJob& job, uint32_t most, uint32_t connected) {
        const WorkCount connections = {most, &job.subpaths.counts->connections};
        schedule.find_connections(job, connections);
        schedule.run("add_connections", connections, AddConnections{job.subpaths, job.film});
        schedule.run("count_subpaths", 1, CountSubpaths{job.subpaths.counts, false, connected});
    }
};

} // namespace pertev
