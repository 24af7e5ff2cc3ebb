#pragma once

// This file defines both schedules of subpaths (integrators/two_schedules.h) and orders the stages of particles once.

#include <memory>
#include <vector>

#include "device_scene/find_hits.h"
#include "integrators/subpaths/particle_stages.h"
#include "integrators/two_schedules.h"
#include "shading/with_stacks.h"

namespace pertev {

class SubpathsWavefront;
class SubpathsLoop;

/// The job of TwoSchedules: a range of samples, each with a subpath from a light or the camera.
struct SubpathJob {
    using Capacity = SubpathCapacity;
    using Counts = SubpathCounts;
    using Loop = SubpathsLoop;
    using Wavefront = SubpathsWavefront;

    SubpathScene scene;
    FilmView film;
    SubpathsView subpaths;
    BeginOrder samples;
    uint64_t first; // first sample
    uint32_t count; // subpaths of each kind

    SubpathCounts* counts() const { return subpaths.counts; }
};
inline std::size_t lay_out(SubpathJob& job, std::byte* memory, const SubpathCapacity& capacity) {
    return lay_out(job.subpaths, memory, capacity);
}
inline RayCounts rays_of(const SubpathCounts& counts) { return {0, counts.bounces, counts.all_connections}; }

inline WorldSphere sphere_round(const Bounds3& bounds) {
    if (bounds.is_empty()) return {};
    return {bounds.centre(), 0.51f * length(bounds.size())}; // half the diagonal, with a margin for rounding
}

class SubpathsWavefront : public WavefrontSchedule<SubpathCounts> {
public:
    using WavefrontSchedule::WavefrontSchedule;

    void find_hits(RayKind kind, const SubpathJob& job, WorkCount rays, uint32_t round) {
        tracer_.find_hits(kind, job.subpaths.query(round), rays, job.subpaths.hits());
    }
    /// Traces connections; connection_keys becomes kNoHit for unoccluded ones.
    void find_connections(const SubpathJob& job, WorkCount connections) {
        tracer_.find_occlusions(job.subpaths.connection_query(), connections, {nullptr, job.subpaths.connection_keys});
    }
    void find_connections_of_camera(const SubpathJob& job, WorkCount connections) {
        if (job.scene.picture.scene.any_hidden_back == 0) return find_connections(job, connections);
        tracer_.find_hits(RayKind::Camera, job.subpaths.connection_query(), connections,
                          {job.subpaths.hit_records, job.subpaths.connection_keys});
    }
};

class SubpathsLoop : public LoopSchedule<SubpathCounts> {
public:
    SubpathsLoop(const HostTrees& trees, const SubpathJob& job)
        : LoopSchedule(trees), hits_(std::size_t(job.subpaths.capacity.count) * job.subpaths.capacity.connections),
          are_occluded_(std::make_unique<bool[]>(hits_.size())) {}

    void find_hits(RayKind kind, const SubpathJob& job, WorkCount rays, uint32_t round) {
        const SubpathsView& subpaths = job.subpaths;
        const SceneView& scene = job.scene.picture.scene;
        const Ray* current = subpaths.rays[round % 2];
        const auto ray_of = [&](uint32_t i) { return current[i]; };
        const auto accept_of = [&](uint32_t i) {
            return AcceptHit{scene, subpaths.start_of(i, round), {}, subpaths.keys[i]};
        };
        pertev::find_hits(trees_, scene, kind == RayKind::Camera, rays.value(), ray_of, accept_of, hits_.data());
        for (uint32_t i = 0; i < rays.value(); ++i) subpaths.hits().store(i, hits_[i]);
    }
    void find_connections(const SubpathJob& job, WorkCount connections) {
        const SubpathsView& subpaths = job.subpaths;
        find_occlusions(
            trees_, connections.value(), RayOrder::Together, [&](uint32_t i) { return subpaths.connection_rays[i]; },
            [&](uint32_t i) { return accept_connection(job, i); }, are_occluded_.get());
        for (uint32_t i = 0; i < connections.value(); ++i) subpaths.connection_keys[i] = are_occluded_[i] ? 0 : kNoHit;
    }
    void find_connections_of_camera(const SubpathJob& job, WorkCount connections) {
        if (job.scene.picture.scene.any_hidden_back == 0) return find_connections(job, connections);
        const SubpathsView& subpaths = job.subpaths;
        find_occlusions(
            trees_, connections.value(), RayOrder::Together, [&](uint32_t i) { return subpaths.connection_rays[i]; },
            [&](uint32_t i) {
                return AcceptCameraHit{accept_connection(job, i), subpaths.connection_rays[i].direction};
            },
            are_occluded_.get());
        for (uint32_t i = 0; i < connections.value(); ++i) subpaths.connection_keys[i] = are_occluded_[i] ? 0 : kNoHit;
    }

private:
    static AcceptHit accept_connection(const SubpathJob& job, uint32_t i) {
        const Uint2 start = job.subpaths.connection_starts[i], target = job.subpaths.connection_targets[i];
        return {job.scene.picture.scene, {start.x, start.y}, {target.x, target.y}, job.subpaths.connection_keys[i]};
    }

    std::vector<Hit> hits_;
    std::unique_ptr<bool[]> are_occluded_;
};

/// Calls run.operator()<kVariant, kInMedia>() for a scene of either kind.
template <class Run>
void with_media(const SceneView& scene, const Run& run) {
    if (scene.has_media != 0) return run.template operator()<ShadingVariant::General, true>();
    with_plain_diffuse(scene.variant, [&]<ShadingVariant kVariant>() { run.template operator()<kVariant, false>(); });
}

/// Calls run.operator()<kVariant, Choice>() with the materials' variant and the class that selects lights
/// (shading/light_set.h). The light tree has kernels for surfaces with lobes alone, and with kHasOneByTree one for all,
/// because a kernel is a megabyte of machine code.
template <bool kHasOneByTree = false, class Run>
void with_choice(const SubpathScene& scene, const Run& run) {
    const ShadingVariant variant = scene.picture.scene.variant;
    if (uses_light_tree(scene)) {
        if constexpr (kHasOneByTree) {
            run.template operator()<ShadingVariant::General, ChosenByTree>();
        } else {
            with_stacks(variant, [&]<ShadingVariant kVariant>() { run.template operator()<kVariant, ChosenByTree>(); });
        }
    } else {
        with_plain_diffuse(variant,
                           [&]<ShadingVariant kVariant>() { run.template operator()<kVariant, ChosenByPower>(); });
    }
}

/// Calls run.operator()<kVariant, kInMedia, Choice>() for a scene of either kind, as with_choice does.
template <bool kHasOneByTree = false, class Run>
void with_media_and_choice(const SubpathScene& scene, const Run& run) {
    if (scene.picture.scene.has_media == 0) {
        return with_choice<kHasOneByTree>(scene, [&]<ShadingVariant kVariant, class Choice>() {
            run.template operator()<kVariant, false, Choice>();
        });
    }
    if (uses_light_tree(scene)) return run.template operator()<ShadingVariant::General, true, ChosenByTree>();
    run.template operator()<ShadingVariant::General, true, ChosenByPower>();
}

/// Traces all particles of the job to their ends and adds those that the camera sees to the film. With kIsConnected,
/// their MIS weights know how next-event estimation selects lights.
template <bool kIsConnected, class Schedule>
void run_particles(Schedule& schedule, const SubpathJob& job) {
    const SubpathsView& subpaths = job.subpaths;
    schedule.run("begin_subpaths", 1, BeginSubpaths{subpaths.counts, 0});
    const SceneView& scene = job.scene.picture.scene;
    schedule.run("begin_particles", job.count, BeginParticles{job.scene, subpaths, job.samples, job.first});
    schedule.run("count_subpaths", 1, CountSubpaths{subpaths.counts, true, 0});
    schedule.begin_rounds(job.count);
    for (uint32_t round = 0; round < job.scene.settings.max_depth && schedule.has_rays_left(subpaths.counts); ++round) {
        const WorkCount rays = {schedule.max_rays(), &subpaths.counts->rays};
        const WorkCount connections = {schedule.max_rays(), &subpaths.counts->connections};
        schedule.find_hits(RayKind::Bounce, job, rays, round);
        const auto shade = [&]<ShadingVariant kVariant, bool kInMedia, class Choice = ChosenByPower>() {
            schedule.run("shade_particles", rays,
                         ShadeParticles<kVariant, kInMedia, Choice>{job.scene, subpaths, round});
        };
        if constexpr (kIsConnected) {
            with_media_and_choice(job.scene, shade);
        } else {
            with_media(scene, shade);
        }
        schedule.find_connections_of_camera(job, connections);
        schedule.run("add_splats", connections, AddSplats{subpaths, job.scene.picture.camera.filter, job.film});
        schedule.run("count_subpaths", 1, CountSubpaths{subpaths.counts, true, 0});
    }
}

} // namespace pertev
