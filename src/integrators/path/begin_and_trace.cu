#include "integrators/path/begin_and_trace.h"

#include "device/launch_body.h"
#include "trace/binary/octant_traversal.h"
#include "tracer/kernels/queue_stages.h"

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
    const auto& scene = std::get<SceneTrees<BvhView>>(tracer.tracer(RayKind::Camera).structure().trees());
    const SingleTree<BvhView> baked = {scene.baked};
    const auto run = [&]<class Accept>(const auto& trees, Accept*) {
        using Stage = BeginAndTrace<kInBatch, Accept, std::remove_cvref_t<decltype(trees)>>;
        launch_on_gpu(queue, "begin_and_trace", fresh, Stage{generate, trees, query, hits});
    };
    using AcceptAtRest = AcceptQueued<false>;
    if (scene.tlas_root != kNoLink) {
        run(scene, static_cast<AcceptAtRest*>(nullptr));
    } else if (query.is_opaque()) {
        run(baked, static_cast<AcceptOpaque*>(nullptr));
    } else {
        run(baked, static_cast<AcceptAtRest*>(nullptr));
    }
    return true;
#else
    return false;
#endif
}

template bool begin_and_trace(Queue&, const SceneTracer&, WorkCount, const GeneratePaths<false>&, const HitQueueView&);
template bool begin_and_trace(Queue&, const SceneTracer&, WorkCount, const GeneratePaths<true>&, const HitQueueView&);

} // namespace pertev
