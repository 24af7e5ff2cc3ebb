#include "trace/binary/while_while_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

void add_while_while_kernels(std::vector<WalkKernel>& rows) {
    add_other_kernels<WhileWhileWalk, true>(WalkKind::WhileWhile, rows);
    add_woop_kernels<WhileWhileWalk>(WalkKind::WhileWhile, rows);
}

} // namespace pertev
