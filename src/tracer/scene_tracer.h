#pragma once

// The one host door to "find these hits" and "find these occlusions": a tracer for each kind of ray, over the
// structures that they need, with the scene's rules of what counts as a hit. Integrators hand queues of rays to it and
// know neither trees nor walks.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/stopwatch.h"
#include "device/buffer.h"
#include "device_scene/ray_queue.h"
#include "device_scene/scene_view.h"
#include "tracer/scene_structures.h"
#include "tracer/tracer.h"

namespace pertev {

class SceneTracer {
public:
    /// `queue` outlives it. Throws Error(BadInput) as check_choice does, Error(OutOfMemory), Error(OverLimit).
    SceneTracer(Queue& queue, SceneStructures& structures, const TracerChoice& choice);

    /// The scene after a change, or another: memory of trees that is large enough stays, and only what has become
    /// another is copied. Throws Error(OutOfMemory), Error(OverLimit); the tracer is then of no more use.
    void set_structures(SceneStructures& structures);

    /// Whether the trees of meshes whose vertices move are kept on the device, in the layouts of all kinds of rays.
    bool can_deform() const;
    /// Where it can: fits them to these meshes, and makes the top level anew. `placed`: what that is built of, with the
    /// bounds of the other trees. Throws Error(OverLimit) as top_level_over, Error(OutOfMemory, DeviceFault).
    void deform(std::span<const DeformedMesh> meshes, std::span<const PlacedBvh> placed);

    /// What the rays meet is part of this scene: its surfaces say which candidates count. Its arrays stay where they
    /// are as long as rays are traced.
    void set_surfaces(const SceneView& scene);

    /// What rays [0, count) meet first. Queued: the work may still be under way. `pool`: Tracer::find_hits. Throws
    /// Error(DeviceFault).
    void find_hits(RayKind kind, const RayQueueView& rays, WorkCount count, const HitQueueView& hits,
                   uint32_t* pool = nullptr);
    /// Whether shadow rays meet anything.
    void find_occlusions(const RayQueueView& rays, WorkCount count, const HitQueueView& hits, uint32_t* pool = nullptr);

    /// What a loop over rays on the host may walk by itself, by device_scene/find_hits.h. Null unless rays of all kinds
    /// are traced so.
    const HostTrees* host_trees() const { return host_trees_; }
    const TracerChoice& choice() const { return choice_; }
    /// Of all that rays can meet, the scene's moved world.
    const Bounds3& bounds() const { return bounds_; }
    const Tracer& tracer(RayKind kind) const { return *tracers_[static_cast<std::size_t>(kind)]; }

    /// Whether rays of each kind are timed from now on, by waiting before and after, which is slower. Seconds since
    /// then.
    struct Seconds {
        double camera = 0, bounce = 0, shadow = 0;
        double total() const { return camera + bounce + shadow; }
    };
    void time_kinds(bool is_timed) {
        is_timed_ = is_timed;
        seconds_ = {};
    }
    bool times_kinds() const { return is_timed_; }
    /// Runs `trace`, which finds by itself what rays of this kind meet, and times it with those that are traced here.
    template <class Trace>
    void timed(RayKind kind, const Trace& trace) {
        if (!is_timed_) return trace();
        queue_.wait();
        const Stopwatch watch;
        trace();
        queue_.wait();
        seconds_of(kind) += watch.seconds();
    }
    const Seconds& seconds() const { return seconds_; }

private:
    TraceQuery query_of(RayKind kind, const RayQueueView& rays) const;
    double& seconds_of(RayKind kind) {
        if (kind == RayKind::Shadow) return seconds_.shadow;
        return kind == RayKind::Camera ? seconds_.camera : seconds_.bounce;
    }

    Queue& queue_;
    TracerChoice choice_;
    std::vector<std::shared_ptr<StructureOnDevice>> structures_; // [RayKind], one and the same for kinds that share it
    std::vector<std::unique_ptr<Tracer>> tracers_;               // [RayKind]
    const HostTrees* host_trees_ = nullptr;
    SceneView scene_{};
    Buffer<SceneView> scene_on_device_;
    Bounds3 bounds_, baked_bounds_; // SceneStructures'
    bool is_timed_ = false;
    Seconds seconds_;
};

} // namespace pertev
