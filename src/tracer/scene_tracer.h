#pragma once

// The host interface for ray queries: a tracer for each kind of ray, over the structures that these need, with the
// scene's rules about which candidates count. Integrators pass queues of rays to it and know neither trees nor
// traversals.

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
    /// Makes the tracers of a choice. `queue` outlives them. Throws Error(BadInput) as check_choice does,
    /// Error(OutOfMemory), Error(OverLimit).
    SceneTracer(Queue& queue, SceneStructures& structures, const TracerChoice& choice);

    /// Switches to the structures of a changed or another scene. Tree memory is reused if it is large enough, and
    /// only changed arrays are copied. Throws Error(OutOfMemory), Error(OverLimit); the tracer is unusable
    /// afterwards.
    void set_structures(SceneStructures& structures);

    /// Returns whether the trees of meshes whose vertices move are refitted on the device, for the layouts of all ray
    /// kinds.
    bool can_deform() const;
    /// Refits the trees of these meshes and rebuilds the TLAS; can_deform() must hold. `placed` lists what the
    /// TLAS contains, with the bounds of the other trees. Throws Error(OverLimit) as tlas_over,
    /// Error(OutOfMemory, DeviceFault).
    void deform(std::span<const DeformedMesh> meshes, std::span<const PlacedBvh> placed);

    /// Sets the surfaces of the scene, which decide which candidates count. Their arrays must stay where they are
    /// while rays are traced.
    void set_surfaces(const SceneView& scene);

    /// Finds the closest hits of rays [0, count). The work is queued and may still run on return. `pool`: see
    /// Tracer::find_hits. Throws Error(DeviceFault).
    void find_hits(RayKind kind, const RayQueueView& rays, WorkCount count, const HitQueueView& hits,
                   uint32_t* pool = nullptr);
    /// Finds whether shadow rays hit anything, under the contract of find_hits().
    void find_occlusions(const RayQueueView& rays, WorkCount count, const HitQueueView& hits, uint32_t* pool = nullptr);

    /// The query of rays of a kind, for kernels that trace what they have made themselves.
    TraceQuery query_of(RayKind kind, const RayQueueView& rays) const;

    /// The trees that a ray loop on the host may traverse directly (device_scene/find_hits.h). Null unless rays of
    /// all kinds use them.
    const HostTrees* host_trees() const { return host_trees_; }
    const TracerChoice& choice() const { return choice_; }
    /// Bounds of everything that rays can hit, in the translated world.
    const Bounds3& bounds() const { return bounds_; }
    const Tracer& tracer(RayKind kind) const { return *tracers_[static_cast<std::size_t>(kind)]; }

    /// Switches timing of each ray kind on or off. Timed traces wait before and after, which is slower. The seconds
    /// start at 0.
    struct Seconds {
        double camera = 0, bounce = 0, shadow = 0;
        double total() const { return camera + bounce + shadow; }
    };
    void time_kinds(bool is_timed) {
        is_timed_ = is_timed;
        seconds_ = {};
    }
    bool times_kinds() const { return is_timed_; }
    /// Runs `trace`, which traces rays of this kind by itself, and adds its time to that kind.
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
    double& seconds_of(RayKind kind) {
        if (kind == RayKind::Shadow) return seconds_.shadow;
        return kind == RayKind::Camera ? seconds_.camera : seconds_.bounce;
    }

    Queue& queue_;
    TracerChoice choice_;
    std::vector<std::shared_ptr<StructureOnDevice>> structures_; // [RayKind]; kinds with the same structure share it
    std::vector<std::unique_ptr<Tracer>> tracers_;               // [RayKind]
    const HostTrees* host_trees_ = nullptr;
    SceneView scene_{};
    Buffer<SceneView> scene_on_device_;
    Bounds3 bounds_, baked_bounds_; // the bounds of SceneStructures
    bool is_timed_ = false;
    Seconds seconds_;
};

} // namespace pertev
