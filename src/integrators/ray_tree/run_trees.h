#pragma once

// This file defines both schedules of trees of rays (integrators/two_schedules.h) and orders their stages once.

#include <memory>
#include <vector>

#include "device_scene/find_hits.h"
#include "integrators/ray_tree/tree_stages.h"
#include "integrators/two_schedules.h"
#include "shading/with_stacks.h"

namespace pertev {

class TreesWavefront;
class TreesLoop;

/// The job of TwoSchedules: a range of samples, each the root of a tree.
struct TreeJob {
    using Capacity = TreeCapacity;
    using Counts = TreeCounts;
    using Loop = TreesLoop;
    using Wavefront = TreesWavefront;

    PictureView picture;
    RayTreeSettings settings;
    FilmView film;
    TreesView trees;
    BeginOrder samples;
    uint64_t first; // first sample
    uint32_t count; // number of trees

    TreeCounts* counts() const { return trees.counts; }
};
inline std::size_t lay_out(TreeJob& job, std::byte* memory, const TreeCapacity& capacity) {
    return lay_out(job.trees, memory, capacity);
}
inline RayCounts rays_of(const TreeCounts& counts) { return {0, counts.bounces, counts.all_shadows}; }

class TreesWavefront : public WavefrontSchedule<TreeCounts> {
public:
    using WavefrontSchedule::WavefrontSchedule;

    void find_hits(RayKind kind, const TreeJob& job, WorkCount rays) {
        tracer_.find_hits(kind, job.trees.query(), rays, job.trees.hits());
    }
    /// Sets shadow_keys to kNoHit where a shadow ray meets nothing.
    void find_occlusions(const TreeJob& job, WorkCount shadows) {
        tracer_.find_occlusions(job.trees.shadow_query(), shadows, {nullptr, job.trees.shadow_keys});
    }
};

class TreesLoop : public LoopSchedule<TreeCounts> {
public:
    TreesLoop(const HostTrees& trees, const TreeJob& job)
        : LoopSchedule(trees), hits_(job.trees.capacity),
          are_occluded_(std::make_unique<bool[]>(hits_.size() * kShadowsAtOnce)) {}

    void find_hits(RayKind kind, const TreeJob& job, WorkCount rays) {
        const TreesView& trees = job.trees;
        const SceneView& scene = job.picture.scene;
        const auto ray_of = [&](uint32_t i) { return trees.rays[i]; };
        const auto accept_of = [&](uint32_t i) {
            return AcceptHit{scene,
                             {trees.starts[i].x, trees.starts[i].y},
                             {},
                             trees.keys[i],
                             trees.times != nullptr ? trees.times[i] : kAtRest};
        };
        pertev::find_hits(trees_, scene, kind == RayKind::Camera, rays.value(), ray_of, accept_of, hits_.data());
        for (uint32_t i = 0; i < rays.value(); ++i) trees.hits().store(i, hits_[i]);
    }
    void find_occlusions(const TreeJob& job, WorkCount shadows) {
        const TreesView& trees = job.trees;
        const auto ray_of = [&](uint32_t i) { return trees.shadow_rays[i]; };
        const auto accept_of = [&](uint32_t i) {
            const Uint2 start = trees.shadow_starts[i], target = trees.shadow_targets[i];
            return AcceptHit{job.picture.scene,
                             {start.x, start.y},
                             {target.x, target.y},
                             trees.shadow_keys[i],
                             trees.shadow_times != nullptr ? trees.shadow_times[i] : kAtRest};
        };
        pertev::find_occlusions(trees_, shadows.value(), RayOrder::Together, ray_of, accept_of, are_occluded_.get());
        for (uint32_t i = 0; i < shadows.value(); ++i) trees.shadow_keys[i] = are_occluded_[i] ? 0 : kNoHit;
    }

private:
    std::vector<Hit> hits_;
    std::unique_ptr<bool[]> are_occluded_;
};

/// Returns whether lights are selected by a tree.
template <class Algorithm>
bool uses_light_tree(const RayTreeSettings& settings, uint32_t lights, bool has_times) {
    return Algorithm::kSelectsLights && uses_light_tree(settings.light_choice, lights, has_times);
}

/// Runs ShadeTrees with the least code that the materials need. One kernel serves open and closed shutters, and one all
/// materials where a tree selects lights, because a kernel is a megabyte of machine code.
template <class Algorithm, class Schedule>
void shade_trees(Schedule& schedule, const TreeJob& job, WorkCount rays, uint32_t round, uint32_t first, bool is_last) {
    const auto shade = [&]<ShadingVariant kVariant, class Choice>() {
        schedule.run("shade_trees", rays,
                     ShadeTrees<Algorithm, kVariant, Choice>{job.picture, job.settings, job.film, job.trees, round,
                                                             first, is_last});
    };
    if constexpr (Algorithm::kSelectsLights) {
        if (job.trees.normals != nullptr) return shade.template operator()<ShadingVariant::General, ChosenByTree>();
    }
    with_stacks(job.picture.scene.variant,
                [&]<ShadingVariant kVariant>() { shade.template operator()<kVariant, ChosenByPower>(); });
}

/// Renders samples [job.first, job.first + job.count) and adds them to the film.
template <class Algorithm, class Schedule>
void run_trees(Schedule& schedule, const TreeJob& job) {
    const TreesView& trees = job.trees;
    const CameraRays& camera = job.picture.camera;
    const uint32_t shadows = Algorithm::shadow_rays(job.picture.scene.lights);
    schedule.run("begin_trees", job.count, BeginTrees{camera, job.settings, trees, job.samples, job.first});
    schedule.run("begin_rounds", 1, BeginRounds{trees.counts, job.count});
    schedule.begin_rounds(job.count);
    for (uint32_t round = 0; schedule.has_rays_left(trees.counts); ++round) {
        const uint32_t most = schedule.max_rays();
        const WorkCount rays = {most, &trees.counts->rays};
        schedule.find_hits(round == 0 ? RayKind::Camera : RayKind::Bounce, job, rays);
        for (uint32_t first = 0; first == 0 || first < shadows; first += kShadowsAtOnce) {
            shade_trees<Algorithm>(schedule, job, rays, round, first, first + kShadowsAtOnce >= shadows);
            if (shadows > 0) {
                const uint64_t shadow_slots = uint64_t(most) * std::min(shadows - first, kShadowsAtOnce);
                schedule.find_occlusions(job, {static_cast<uint32_t>(shadow_slots), &trees.counts->shadows});
                schedule.run("add_tree_light", rays, AddTreeLight{trees, round});
            }
            schedule.run("count_trees", 1, CountTrees{trees.counts, false});
        }
        schedule.run("take_next_rays", rays, TakeNextRays{camera, job.settings, job.film, trees, round});
        schedule.run("count_trees", 1, CountTrees{trees.counts, true});
    }
}

} // namespace pertev
