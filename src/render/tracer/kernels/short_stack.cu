#include "render/tracer/kernels/walk_kernels_body.h"
#include "trace/binary/short_stack_walk.h"

namespace pertev {

void add_short_stack_kernels(std::vector<WalkKernel>& rows) {
    add_all_kernels<ShortStackWalk>(WalkKind::ShortStack, rows);
}

} // namespace pertev
