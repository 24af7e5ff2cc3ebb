#include "tracer/tracer.h"

#include "base/error.h"

namespace pertev {

Tracer::Tracer(Queue& queue, const Combination& combination, std::shared_ptr<const StructureOnDevice> structure)
    : queue_(queue), combination_(combination), structure_(std::move(structure)),
      closest_(find_kernel(combination, false, queue.is_cuda())), any_(find_kernel(combination, true, queue.is_cuda())),
      pool_(queue, Queue::kMaxStreams, "ray pool") {
    PERTEV_CHECK(closest_ != nullptr && any_ != nullptr);
}

/// Returns the ray pool of the current stream, set to 0 by queued work. Null if rays do not come from a pool.
uint32_t* Tracer::empty_pool() const {
    if (combination_.distribution == Distribution::OneAThread) return nullptr;
    uint32_t* const pool = pool_.data() + queue_.stream_index();
    queue_.zero(pool, sizeof *pool);
    return pool;
}

void Tracer::trace(const TraversalKernel& kernel, const TraceQuery& query, WorkCount count, const HitQueueView& hits,
                   uint32_t* pool) const {
    if (count.most == 0) return;
    kernel.trace(queue_, structure_->trees(), {query, count, pool != nullptr ? pool : empty_pool()}, hits);
}

bool Tracer::count_work(bool any_hit, const TraceQuery& query, uint32_t count, RayWork* work) const {
    const TraversalKernel* counting = &kernel(any_hit);
    // The tests of a ray do not depend on its thread, except in traversals where a warp decides together.
    const bool company =
        combination_.traversal == TraversalKind::Speculative || combination_.traversal == TraversalKind::Packet;
    if (counting->count == nullptr && !company) {
        Combination plain = combination_;
        plain.distribution = Distribution::OneAThread;
        counting = find_kernel(plain, any_hit, queue_.is_cuda());
    }
    if (counting == nullptr || counting->count == nullptr) return false;
    counting->count(queue_, structure_->trees(), {query, count}, work); // one ray per thread
    return true;
}

std::optional<LaneCounts> Tracer::count_lanes(bool any_hit, const TraceQuery& query, uint32_t count) const {
    const auto counting = kernel(any_hit).count_lanes;
    if (!queue_.is_cuda() || counting == nullptr) return std::nullopt;
    if (structure_->built().has_instances())
        return std::nullopt; // lane counting is compiled only for scenes with
                             // one tree
    Buffer<LaneCounts> counts(queue_, 1, "lane counts");
    counts.zero();
    counting(queue_, structure_->trees(), {query, count, empty_pool()}, counts.data());
    return counts.download().front();
}

std::optional<KernelLimits> Tracer::limits() const {
    if (!queue_.is_cuda() || closest_->limits == nullptr) return std::nullopt;
    const Queue::Scope scope(queue_, "limits of a kernel"); // CUDA reports limits for the thread's current device
    return closest_->limits(structure_->built().has_instances());
}

} // namespace pertev
