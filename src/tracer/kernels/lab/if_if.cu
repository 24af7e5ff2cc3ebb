#include "trace/binary/if_if_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

void add_if_if_kernels(std::vector<WalkKernel>& rows) { add_all_kernels<IfIfWalk>(WalkKind::IfIf, rows); }

} // namespace pertev
