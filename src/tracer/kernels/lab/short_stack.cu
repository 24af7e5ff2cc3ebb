#include "trace/binary/short_stack_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

void add_short_stack_kernels(std::vector<WalkKernel>& rows) {
    add_all_kernels<ShortStackWalk>(WalkKind::ShortStack, rows);
}

} // namespace pertev
