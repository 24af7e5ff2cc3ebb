#include "integrators/path/begin_and_trace.h"

#include "trace/binary/octant_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

using CameraTraversal = OctantTraversal<TraversalOptions{}>;

/// The stage of one path. `Scene` and `Accept` are those of TraceQueue.
template <bool kInBatch, class Accept, class Scene>
struct BeginAndTrace {
    GeneratePaths<kInBatch> generate;
    Scene scene;
    TraceQuery query;
    HitQueueView hits;

    HD void operator()(uint32_t i) const {
        const Ray ray = generate.begin_and_store(i);
        Hit hit;
        trace_closest<CameraTraversal>(scene, ray, Accept{query, i}, hit, NoTraversalCounter{});
        hits.store(i, hit);
    }
};

template <bool kInBatch>
bool begin_and_trace([[maybe_unused]] Queue& queue, [[maybe_unused]] const SceneTracer& tracer,
                     [[maybe_unused]] WorkCount fresh, [[maybe_unused]] const GeneratePaths<kInBatch>& generate,
                     [[maybe_unused]] const HitQueueView& hits) {
#if defined(__CUDACC__)
    const Combination& by = tracer.choice()[RayKind::Camera];
    const bool is_default = by.traversal == TraversalKind::Octants && by.options == TraversalOptions{} &&
                            by.distribution == Distribution::OneAThread;
    const TraceQuery query = tracer.query_of(RayKind::Camera, generate.paths.query_back(generate.last));
    if (!queue.is_cuda() || !is_default || query.moving != nullptr || tracer.times_kinds()) return false;
    const AnyTrees& trees = tracer.tracer(RayKind::Camera).structure().trees();
    with_kernel<CameraTraversal, true, true>(trees, query, [&]<class Kernel>(const auto& scene, Kernel) {
        if constexpr (!std::is_same_v<Kernel, AnyScene<CameraTraversal>>) {
            using Stage = BeginAndTrace<kInBatch, typename Kernel::Accept, typename Kernel::Scene>;
            launch_on_gpu(queue, "begin_and_trace", fresh, Stage{generate, scene, query, hits});
        }
    });
    return true;
#else
    return false;
#endif
}

template bool begin_and_trace(Queue&, const SceneTracer&, WorkCount, const GeneratePaths<false>&, const HitQueueView&);
template bool begin_and_trace(Queue&, const SceneTracer&, WorkCount, const GeneratePaths<true>&, const HitQueueView&);

} // namespace pertev
