#include "lab/trace_rays.h"

#include "device/launch_body.h"
#include "lab/binary_stack_walk.h"

namespace pertev {
template void launch(Queue&, const char*, uint32_t, const TraceRays<StackWalk, false>&);
template void launch(Queue&, const char*, uint32_t, const TraceRays<StackWalk, true>&);
template void launch(Queue&, const char*, uint32_t, const TraceRays<StackWalk, false, SingleTree<BvhView>>&);
template void launch(Queue&, const char*, uint32_t, const TraceRays<StackWalk, true, SingleTree<BvhView>>&);
template void launch(Queue&, const char*, uint32_t, const TraceRays<BinaryStackWalk, false, SingleTree<BvhView>>&);
template void launch(Queue&, const char*, uint32_t, const TraceRays<BinaryStackWalk, true, SingleTree<BvhView>>&);
template void launch(Queue&, const char*, uint32_t, const TraceRays<BinaryStackWalk, false>&);
template void launch(Queue&, const char*, uint32_t, const TraceRays<BinaryStackWalk, true>&);
template void launch(Queue&, const char*, uint32_t, const CountRays<BinaryStackWalk, false>&);
template void launch(Queue&, const char*, uint32_t, const CountRays<BinaryStackWalk, true>&);
} // namespace pertev
