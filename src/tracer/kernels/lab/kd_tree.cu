#include "trace/cells/kd_tree_walk.h"
#include "tracer/kernels/walk_kernels_body.h"

namespace pertev {

void add_kd_tree_kernels(std::vector<WalkKernel>& rows) { add_all_kernels<KdTreeWalk>(WalkKind::Kd, rows); }

} // namespace pertev
