#pragma once

// The traversal of eight boxes at a time, which only a CPU has: for the files that compile it.

#include <cstdint>

#include "base/parallel_for.h"
#include "trace/wide/traverse_wide.h"
#include "tracer/kernels/queue_stages.h"
#include "tracer/traversal_kernels.h"

namespace pertev {

inline constexpr uint64_t kRaysATask = 256;

template <TraversalOptions kOptions, bool kAny>
void trace_simd(Queue& queue, const AnyTrees& trees, const RayBatch& batch, const HitQueueView& hits) {
    using Traversal = Wide8SimdTraversal<kOptions>;
    using Trees = SceneTrees<typename Traversal::Tree>;
    const TraceQueue<Traversal, kAny, AcceptQueued<true>, Trees> stage = {std::get<Trees>(trees), batch.query, hits};
    const UseThreads use(queue.threads());
    parallel_for(batch.count.value(), kRaysATask, [&](uint64_t i) { stage(static_cast<uint32_t>(i)); });
}

template <TraversalOptions kOptions, bool kAny>
void count_simd(Queue& queue, const AnyTrees& trees, const RayBatch& batch, RayWork* work) {
    using Traversal = Wide8SimdTraversal<kOptions>;
    const CountQueue<Traversal, kAny> stage = {std::get<SceneTrees<typename Traversal::Tree>>(trees), batch.query,
                                               work};
    const UseThreads use(queue.threads());
    parallel_for(batch.count.value(), kRaysATask, [&](uint64_t i) { stage(static_cast<uint32_t>(i)); });
}

template <TraversalOptions kOptions, bool kAny>
void add_simd_row(std::vector<TraversalKernel>& rows) {
    constexpr TraversalOptions kCompiled = kAny ? for_any_hit(kOptions) : kOptions;
    rows.push_back({TraversalKind::Wide8Simd, kOptions, Distribution::OneAThread, kAny, false, true,
                    trace_simd<kCompiled, kAny>, count_simd<kCompiled, kAny>, nullptr, nullptr});
}

} // namespace pertev
