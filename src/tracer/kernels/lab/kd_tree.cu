#include "trace/cells/kd_tree_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

void add_kd_tree_kernels(std::vector<TraversalKernel>& rows) {
    add_all_kernels<KdTreeTraversal>(TraversalKind::Kd, rows);
}

} // namespace pertev
