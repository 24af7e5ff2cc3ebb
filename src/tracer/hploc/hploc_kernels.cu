#include "tracer/hploc/hploc_kernels.h"

#include "accel/hploc/leaves.h"
#include "base/parallel_until.h"
#include "device/launch_body.h"
#include "tracer/hploc/refit.h"

#if defined(__CUDACC__)
#include "tracer/hploc/warp_kernels.h"
#endif

namespace pertev {

template void launch(Queue&, const char*, WorkCount, const hploc::FindBounds&);
template void launch(Queue&, const char*, WorkCount, const hploc::MakeCodes&);
template void launch(Queue&, const char*, WorkCount, const hploc::StoreLeaves&);
template void launch(Queue&, const char*, WorkCount, const hploc::EmitLevel&);
template void launch(Queue&, const char*, WorkCount, const hploc::LinkParents&);
template void launch(Queue&, const char*, WorkCount, const hploc::MoveTriangles&);
template void launch(Queue&, const char*, WorkCount, const hploc::RefitNodes&);

void launch_climb(Queue& queue, const hploc::Climb& climb, Sink& sink) {
#if defined(__CUDACC__)
    if (queue.is_cuda()) {
        const Queue::Scope scope(queue, "join clusters");
        constexpr uint32_t threads = hploc::kClimbThreads;
        const uint32_t blocks = (climb.tree.count + threads - 1) / threads;
        hploc::climb_by_warps<<<blocks, threads, 0, static_cast<cudaStream_t>(queue.stream())>>>(climb);
        return queue.check_launch();
    }
#endif
    if (queue.is_dry_run()) return;
    const Queue::Scope scope(queue, "join clusters");
    const UseThreads use(queue.threads());
    const hploc::ClimbFromLeaves stage = {climb};
    parallel_until(climb.tree.count, 256, sink, [&](uint64_t i) { stage(static_cast<uint32_t>(i)); });
}

bool launch_emit(Queue& queue, const hploc::EmitWide& emit) {
#if defined(__CUDACC__)
    if (queue.is_cuda()) {
        const Queue::Scope scope(queue, "make wide nodes");
        constexpr uint32_t threads = hploc::kEmitThreads;
        int device = 0, processors = 1, blocks = 1;
        cudaGetDevice(&device);
        cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device);
        cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, hploc::emit_in_turn, threads, 0);
        const uint32_t there = static_cast<uint32_t>(blocks * processors);
        const uint32_t used = min(emit.capacity / (threads / kMaxWidth) + 1, there);
        hploc::emit_in_turn<<<used, threads, 0, static_cast<cudaStream_t>(queue.stream())>>>(emit);
        queue.check_launch();
        return true;
    }
#endif
    static_cast<void>(queue);
    static_cast<void>(emit);
    return false;
}

} // namespace pertev
