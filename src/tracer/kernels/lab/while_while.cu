#include "trace/binary/while_while_traversal.h"
#include "tracer/kernels/traversal_kernels_body.h"

namespace pertev {

void add_while_while_kernels(std::vector<TraversalKernel>& rows) {
    add_other_kernels<WhileWhileTraversal, true>(TraversalKind::WhileWhile, rows);
    add_woop_kernels<WhileWhileTraversal>(TraversalKind::WhileWhile, rows);
}

} // namespace pertev
