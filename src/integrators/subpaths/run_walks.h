#pragma once

// This file defines both schedules of subpaths (integrators/two_schedules.h) and orders the stages of particles once.

#include <memory>
#include <vector>

#include "device_scene/find_hits.h"
#include "integrators/subpaths/particle_stages.h"
#include "integrators/two_schedules.h"

namespace pertev {

class WalksWavefront;
class WalksLoop;

/// The job of TwoSchedules: a range of samples, each with a subpath from a light or the camera.
struct WalkJob {
    using Room = WalkRoom;
    using Counts = WalkCounts;
    using Loop = WalksLoop;
    using Wavefront = WalksWavefront;

    WalkScene scene;
    FilmView film;
    WalksView walks;
    BeginOrder samples;
    uint64_t first; // first sample
    uint32_t count; // subpaths of each kind

    WalkCounts* counts() const { return walks.counts; }
};
inline std::size_t lay_out(WalkJob& job, std::byte* memory, const WalkRoom& room) {
    return lay_out(job.walks, memory, room);
}
inline RayCounts rays_of(const WalkCounts& counts) { return {0, counts.bounces, counts.all_asked}; }

inline WorldSphere sphere_round(const Bounds3& bounds) {
    if (bounds.is_empty()) return {};
    return {bounds.centre(), 0.51f * length(bounds.size())}; // half the diagonal, with a margin for rounding
}

class WalksWavefront : public WavefrontSchedule<WalkCounts> {
public:
    using WavefrontSchedule::WavefrontSchedule;

    void find_hits(RayKind kind, const WalkJob& job, WorkCount rays, uint32_t round) {
        tracer_.find_hits(kind, job.walks.query(round), rays, job.walks.hits());
    }
    /// Traces connections; asked_keys becomes kNoHit for unoccluded ones.
    void find_connections(const WalkJob& job, WorkCount asked) {
        tracer_.find_occlusions(job.walks.asked_query(), asked, {nullptr, job.walks.asked_keys});
    }
    void find_connections_of_camera(const WalkJob& job, WorkCount asked) {
        if (job.scene.picture.scene.any_hidden_back == 0) return find_connections(job, asked);
        tracer_.find_hits(RayKind::Camera, job.walks.asked_query(), asked,
                          {job.walks.hit_places, job.walks.asked_keys});
    }
};

class WalksLoop : public LoopSchedule<WalkCounts> {
public:
    WalksLoop(const HostTrees& trees, const WalkJob& job)
        : LoopSchedule(trees), hits_(std::size_t(job.walks.room.count) * job.walks.room.connections),
          met_(std::make_unique<bool[]>(hits_.size())) {}

    void find_hits(RayKind kind, const WalkJob& job, WorkCount rays, uint32_t round) {
        const WalksView& walks = job.walks;
        const SceneView& scene = job.scene.picture.scene;
        const Ray* under_way = walks.rays[round % 2];
        const auto ray_of = [&](uint32_t i) { return under_way[i]; };
        const auto accept_of = [&](uint32_t i) {
            return AcceptHit{scene, {walks.starts[i].x, walks.starts[i].y}, {}, walks.keys[i]};
        };
        pertev::find_hits(trees_, scene, kind == RayKind::Camera, rays.value(), ray_of, accept_of, hits_.data());
        for (uint32_t i = 0; i < rays.value(); ++i) walks.hits().store(i, hits_[i]);
    }
    void find_connections(const WalkJob& job, WorkCount asked) {
        const WalksView& walks = job.walks;
        find_occlusions(
            trees_, asked.value(), RayOrder::Together, [&](uint32_t i) { return walks.asked_rays[i]; },
            [&](uint32_t i) { return accept_asked(job, i); }, met_.get());
        for (uint32_t i = 0; i < asked.value(); ++i) walks.asked_keys[i] = met_[i] ? 0 : kNoHit;
    }
    void find_connections_of_camera(const WalkJob& job, WorkCount asked) {
        if (job.scene.picture.scene.any_hidden_back == 0) return find_connections(job, asked);
        const WalksView& walks = job.walks;
        find_occlusions(
            trees_, asked.value(), RayOrder::Together, [&](uint32_t i) { return walks.asked_rays[i]; },
            [&](uint32_t i) {
                return AcceptCameraHit{accept_asked(job, i), walks.asked_rays[i].direction};
            },
            met_.get());
        for (uint32_t i = 0; i < asked.value(); ++i) walks.asked_keys[i] = met_[i] ? 0 : kNoHit;
    }

private:
    static AcceptHit accept_asked(const WalkJob& job, uint32_t i) {
        const Uint2 start = job.walks.asked_starts[i], target = job.walks.asked_targets[i];
        return {job.scene.picture.scene, {start.x, start.y}, {target.x, target.y}, job.walks.asked_keys[i]};
    }

    std::vector<Hit> hits_;
    std::unique_ptr<bool[]> met_;
};

/// Calls run.operator()<kKnown>() with the materials' shading variant, as far as subpaths have kernels for it.
template <class Run>
void with_known(MaterialsKnown known, const Run& run) {
    if (known == MaterialsKnown::PlainDiffuse) return run.template operator()<MaterialsKnown::PlainDiffuse>();
    run.template operator()<MaterialsKnown::Nothing>();
}

/// Traces all particles of the job to their ends and adds those that the camera sees to the film.
template <class Way>
void run_particles(Way& way, const WalkJob& job) {
    const WalksView& walks = job.walks;
    way.run("begin_walks", 1, BeginWalks{walks.counts, 0});
    way.run("begin_particles", job.count, BeginParticles{job.scene, walks, job.samples, job.first});
    way.run("count_walks", 1, CountWalks{walks.counts, true, 0});
    way.begin_rounds(job.count);
    for (uint32_t round = 0; round < job.scene.settings.max_depth && way.has_rays_left(walks.counts); ++round) {
        const WorkCount rays = {way.most_rays(), &walks.counts->rays};
        const WorkCount asked = {way.most_rays(), &walks.counts->asked};
        way.find_hits(RayKind::Bounce, job, rays, round);
        with_known(job.scene.picture.scene.known, [&]<MaterialsKnown kKnown>() {
            way.run("shade_particles", rays, ShadeParticles<kKnown>{job.scene, walks, round});
        });
        way.find_connections_of_camera(job, asked);
        way.run("add_splats", asked, AddSplats{walks, job.scene.picture.camera.filter, job.film});
        way.run("count_walks", 1, CountWalks{walks.counts, true, 0});
    }
}

} // namespace pertev
